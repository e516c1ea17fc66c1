#include "graph/types/load_plugin.h"

#include "formats/file/confinement.h"
#include "formats/file/full_path.h"
#include "formats/file/input_file.h"
#include "graph/types/plugin.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>

namespace fluidcarve {
namespace {

namespace fs = std::filesystem;

bool can_name_a_family(std::string_view name) {
    return !name.empty() &&
           std::ranges::all_of(name, [](unsigned char c) { return std::isalnum(c) || c == '_'; });
}

template <class Symbol>
Symbol* find(void* library, const std::string& file, const char* name) {
    auto* const found = reinterpret_cast<Symbol*>(dlsym(library, name));
    if (!found)
        throw Failure(
            fmt::format("{} is no plugin of fluidcarve: it has no symbol '{}'; `fluidcarve "
                        "new-node` writes a complete one",
                        file, name));
    return found;
}

void check(const PluginHeader& header, const std::string& file, const Registry& registry,
           const PluginFiles& files) {
    constexpr auto again = "build it again with the headers of this one";
    if (header.abi != plugin_abi)
        throw Failure(fmt::format("the plugin {} has ABI number {}, but fluidcarve {} takes {}; {}",
                                  file, header.abi, FLUIDCARVE_VERSION, plugin_abi, again));
    if (header.payloads != payload_abi)
        throw Failure(fmt::format(
            "the plugin {} was built with fluidcarve {}, whose payload types are of version {}, "
            "but here, in fluidcarve {}, they are of {}; {}",
            file, header.version, header.payloads, FLUIDCARVE_VERSION, payload_abi, again));
    if (header.node_type != sizeof(NodeType))
        throw Failure(
            fmt::format("the plugin {} was built with fluidcarve {} where a node type takes {} "
                        "bytes, but here it takes {}; {}, and with the same options for the "
                        "standard library",
                        file, header.version, header.node_type, sizeof(NodeType), again));
    const std::string family = header.family ? header.family : "";
    if (!can_name_a_family(family))
        throw Failure(
            fmt::format("the plugin {} gives its types the family '{}'; a family's name has "
                        "letters, digits and _",
                        file, family));
    for (const auto& [name, type] : registry.nodes())
        if (!files.contains(name) && family_of(name) == family)
            throw Failure(
                fmt::format("the plugin {} gives its types the family '{}', but that is a built-in "
                            "one, of '{}'; give it one of its own",
                            file, family, name));
}

/// Checks that all types and conversions of a plugin belong to its family.
/// @param before    the registry without the plugin
/// @param registry  the registry with the plugin
/// @return names of the plugin's node types
/// @throws Failure naming a type or conversion outside of the family
std::vector<std::string> own_types(const Registry& before, const Registry& registry,
                                   const std::string& family, const std::string& file) {
    const auto refuse = [&](const std::string& what, const std::string& name) {
        throw Failure(fmt::format(
            "the plugin {} adds the {} '{}', which is not of its own family '{}'; call it '{}.{}'",
            file, what, name, family, family, name.substr(name.find('.') + 1)));
    };
    std::vector<std::string> out;
    for (const auto& name : registry.node_names()) {
        if (before.node(name)) continue;
        if (family_of(name) != family) refuse("node type", name);
        out.push_back(name);
    }
    const auto known = before.payloads().size();
    for (auto n = known; n < registry.payloads().size(); ++n)
        if (const auto& name = registry.payloads()[n].name; !name.starts_with(family + "."))
            refuse("payload type", name);
    for (const auto& from : before.payloads())
        for (const auto& to : before.payloads())
            if (registry.accepts(to.type, from.type) != before.accepts(to.type, from.type))
                throw Failure(
                    fmt::format("the plugin {} converts '{}' to '{}' for all nodes; it may only "
                                "convert from and to types of its own family '{}'",
                                file, from.name, to.name, family));
            else if (registry.selection(from.type, to.type) != nullptr &&
                     !before.selection(from.type, to.type))
                throw Failure(
                    fmt::format("the plugin {} picks '{}' from '{}' for all nodes; it may only "
                                "pick from and to types of its own family '{}'",
                                file, to.name, from.name, family));
    return out;
}

/// The first path, from a file up to its trusted folder, that every user may write to.
std::optional<fs::path> open_to_all(const fs::path& file, const fs::path& folder) {
    std::error_code error;
    for (auto path = file;; path = path.parent_path()) {
        if ((fs::status(path, error).permissions() & fs::perms::others_write) != fs::perms::none)
            return path;
        if (path == folder || path == path.root_path()) return std::nullopt;
    }
}

/// Why a plugin may not be loaded, with the remedy; empty if it may.
std::string refusal(const std::string& as_written, const fs::path& file, const PluginTrust& trust) {
    if (trust.all) return {};
    std::string why = "nobody allowed that";
    for (const auto& each : trust.folders) {
        std::error_code error;
        const auto folder = fs::canonical(each, error);
        if (error || std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first !=
                         folder.end())
            continue;
        const auto open = open_to_all(file, folder);
        if (!open) return {};
        why = fmt::format("it lies in the trusted folder {}, but everybody may write to {}", each,
                          open->string());
    }
    return fmt::format(
        "the plugin {} is not loaded: it is code that would run with your rights, and {}; if you "
        "trust {}, give --allow-plugins, or name a folder that holds it, and that only you may "
        "write to, in the environment variable FLUIDCARVE_PLUGINS",
        as_written, why, file.string());
}

/// The existing file that a plugin path refers to.
/// @param looked  receives the paths that do not exist
std::optional<fs::path> find_file(const Value& path, const PluginTrust& trust,
                                  std::vector<std::string>& looked) {
    std::vector<fs::path> folders{path.mark.source ? path.mark.source->folder : "", ""};
    for (const auto& folder : trust.folders) folders.emplace_back(folder);
    for (const auto& folder : folders) {
        std::error_code error;
        const auto file = full_path(folder / path.text);
        if (fs::is_regular_file(file, error)) return fs::canonical(file, error);
        if (std::ranges::find(looked, file.string()) == looked.end())
            looked.push_back(file.string());
    }
    return std::nullopt;
}

}  // namespace

std::vector<std::string> trusted_plugin_folders() {
    const char* const variable = std::getenv("FLUIDCARVE_PLUGINS");
    std::istringstream list(variable ? variable : "");
    std::vector<std::string> out;
    for (std::string folder; std::getline(list, folder, ':');)
        if (fs::path(folder).is_absolute()) out.push_back(folder);
    return out;
}

void load_plugin(const std::string& file, Registry& registry, PluginFiles& files) {
    for (const auto& [type, loaded] : files)
        if (loaded == file) return;
    // The loader would wait for the writer of a pipe.
    static_cast<void>(InputFile(file, {.what = "a plugin", .anywhere = true}));
    // The path must be absolute: for a bare name dlopen searches the system's folders. RTLD_NOW
    // finds missing symbols now; found later, they would end the program.
    void* const library = dlopen(fs::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library)
        throw Failure(fmt::format(
            "the plugin {} can't be opened: {}; build it again with the headers of fluidcarve {}",
            file, dlerror(), FLUIDCARVE_VERSION));
    const auto& header = *find<const PluginHeader>(library, file, "fluidcarve_plugin");
    check(header, file, registry, files);
    auto* const add_types = find<void(Registry&)>(library, file, "fluidcarve_register");
    auto with_plugin = registry;
    try {
        add_types(with_plugin);
    } catch (const std::exception& error) {
        throw Failure(
            fmt::format("the plugin {} failed to register its types: {}; none of them can be used",
                        file, error.what()));
    } catch (...) {
        throw Failure(
            fmt::format("the plugin {} failed to register its types: it threw something that is "
                        "not a std::exception; none of them can be used",
                        file));
    }
    for (const auto& type : own_types(registry, with_plugin, header.family, file))
        files[type] = file;
    registry = std::move(with_plugin);
}

void load_plugins(const Value& paths, const PluginTrust& trust, Registry& registry,
                  PluginFiles& files, Problems& problems) {
    for (const auto& path : paths.items) {
        if (path.kind != Value::Kind::scalar) continue;
        const auto refuse = [&](const std::string& message) { add(problems, path.mark, message); };
        std::vector<std::string> looked;
        const auto file = find_file(path, trust, looked);
        if (!file) {
            refuse(fmt::format("there is no plugin {}: no file {}; build it, or correct the path",
                               path.text, fmt::join(looked, ", ")));
        } else if (const auto outside = Confinement::of_program().refusal(file->string());
                   !outside.empty()) {
            refuse(fmt::format("the plugin {} is not loaded: it {}", path.text, outside));
        } else if (const auto why = refusal(path.text, *file, trust); !why.empty()) {
            refuse(why);
        } else {
            try {
                load_plugin(file->string(), registry, files);
            } catch (const Failure& failure) {
                refuse(failure.what());
            }
        }
    }
}

}  // namespace fluidcarve
