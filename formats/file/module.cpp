#include "formats/file/module.h"

#include "carve/base/failure.h"
#include "formats/file/needed_libraries.h"

#include <fmt/format.h>

#include <dlfcn.h>
#include <filesystem>
#include <map>
#include <mutex>

namespace fluidcarve {
namespace {

namespace fs = std::filesystem;

const void* open_module(const std::string& name, const std::string& package) {
    const auto path = (library_folder() / fmt::format("fluidcarve_{}.so", name)).string();
    if (!fs::exists(path))
        throw Failure(
            fmt::format("the module '{0}' is missing: there is no {1}; unpack the archive '{0}' of "
                        "this version over fluidcarve's, or install {2} and build fluidcarve again",
                        name, path, package));
    // Symbols are looked up in all libraries that are opened together: hundreds behind a module.
    // If the libraries are opened one by one before it, beginning with those that need no other,
    // each symbol is looked up only in the few that its own library needs: half of the time. A
    // library that fails here is opened with the module.
    for (const auto& library : needed_libraries(path))
        dlopen(library.c_str(), RTLD_LAZY | RTLD_LOCAL);
    // Most functions of the hundreds of libraries behind a module are never called: looking up all
    // of them takes a third of the time.
    void* const library = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (!library)
        throw Failure(fmt::format(
            "the module '{}' can't be opened: {}; install what it needs, or build it again", name,
            dlerror()));
    const auto* const module = static_cast<const Module*>(dlsym(library, "fluidcarve_module"));
    if (!module) throw Failure(fmt::format("{} is no module of fluidcarve; build it again", path));
    if (module->version != std::string(FLUIDCARVE_VERSION))
        throw Failure(fmt::format(
            "{} belongs to fluidcarve {}, but this is {}; build or install both together", path,
            module->version, FLUIDCARVE_VERSION));
    return module->table;
}

}  // namespace

fs::path library_folder() {
    Dl_info self{};
    std::error_code error;
    return dladdr(reinterpret_cast<const void*>(&library_folder), &self) != 0
               ? fs::weakly_canonical(self.dli_fname, error).parent_path()
               : fs::path();
}

const void* module_table(const std::string& name, const std::string& package) {
    static std::mutex mutex;
    static std::map<std::string, const void*> opened;
    const std::lock_guard lock(mutex);
    const auto found = opened.find(name);
    return found != opened.end() ? found->second
                                 : opened.emplace(name, open_module(name, package)).first->second;
}

std::string shared_folder(const std::string& name) {
    const auto beside = library_folder() / name,
               installed = (library_folder() / "../../share/fluidcarve" / name).lexically_normal();
    for (const auto& folder : {beside, installed})
        if (fs::is_directory(folder)) return folder.string();
    throw Failure(
        fmt::format("there is no folder '{}' of files that come with the program; looked for {}, "
                    "{}; build or install it with the program",
                    name, beside.string(), installed.string()));
}

}  // namespace fluidcarve
