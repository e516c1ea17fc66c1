#include "graph/types/module.h"

#include "graph/text/problem.h"
#include "graph/types/needed_libraries.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <mutex>
#include <vector>

namespace fluidcarve {
namespace {

namespace fs = std::filesystem;

/// The folders of this library and of the program.
std::vector<fs::path> homes() {
    std::error_code error;
    Dl_info self{};
    std::vector<fs::path> out;
    if (dladdr(reinterpret_cast<const void*>(&module_table), &self) != 0) out.push_back(fs::weakly_canonical(self.dli_fname, error).parent_path());
    out.push_back(fs::read_symlink("/proc/self/exe", error).parent_path());
    return out;
}

/// A folder in each home, and one beside it. @param in_home  empty: the home itself
std::vector<fs::path> folders(const std::string& in_home, const std::string& beside) {
    std::vector<fs::path> out;
    for (const auto& home : homes())
        for (const auto& folder : {in_home.empty() ? home : home / in_home, (home / beside).lexically_normal()})
            if (std::find(out.begin(), out.end(), folder) == out.end()) out.push_back(folder);
    return out;
}

const void* open(const std::string& name) {
    const auto file = fmt::format("fluidcarve_{}.so", name);
    std::string looked;
    for (const auto& folder : folders("", "../lib/fluidcarve")) {
        const auto path = (folder / file).string();
        looked += (looked.empty() ? "" : ", ") + folder.string();
        if (!fs::exists(path)) continue;
        // Symbols are looked up in all libraries that are opened at once. There are hundreds behind a module. Opened one by one before it, from those that
        // need no other, each is looked up in the few that its own library needs: half of the time. One that fails here is opened with the module.
        for (const auto& library : needed_libraries(path)) dlopen(library.c_str(), RTLD_LAZY | RTLD_LOCAL);
        // Most functions of the hundreds of libraries behind a module are never called: looking up all takes a third of the time.
        void* const library = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
        if (!library) throw Failure(fmt::format("the module '{}' can't be opened: {}; install what it needs, or build it again", name, dlerror()));
        const auto* const module = static_cast<const Module*>(dlsym(library, "fluidcarve_module"));
        if (!module) throw Failure(fmt::format("{} is no module of fluidcarve; build it again", path));
        if (module->version != std::string(FLUIDCARVE_VERSION))
            throw Failure(
                fmt::format("{} belongs to fluidcarve {}, but this is {}; build or install both together", path, module->version, FLUIDCARVE_VERSION));
        return module->table;
    }
    throw Failure(fmt::format("the module '{}' is missing: there is no {} in {}; build or install it beside the program", name, file, looked));
}

}  // namespace

const void* module_table(const std::string& name) {
    static std::mutex mutex;
    static std::map<std::string, const void*> opened;
    const std::lock_guard lock(mutex);
    const auto found = opened.find(name);
    return found != opened.end() ? found->second : opened.emplace(name, open(name)).first->second;
}

std::string shared_folder(const std::string& name) {
    std::string looked;
    for (const auto& folder : folders(name, "../share/fluidcarve/" + name)) {
        looked += (looked.empty() ? "" : ", ") + folder.string();
        if (fs::is_directory(folder)) return folder.string();
    }
    throw Failure(
        fmt::format("there is no folder '{}' of files that come with the program; looked for {}; build or install it with the program", name, looked));
}

}  // namespace fluidcarve
