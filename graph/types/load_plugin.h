#pragma once

#include "graph/text/value.h"
#include "graph/types/registry.h"

#include <map>
#include <string>
#include <vector>

namespace fluidcarve {

/// Node type to the plugin file that declares it.
using PluginFiles = std::map<std::string, std::string, std::less<>>;

/// Which plugins a pipeline may load. A plugin is code that runs with all rights of the user.
struct PluginTrust {
    bool all = false;                  ///< any file: `--allow-plugins`
    std::vector<std::string> folders;  ///< trusted folders: files in these or their subfolders
};

/// The folders in the environment variable FLUIDCARVE_PLUGINS, separated by colons. Relative ones
/// are ignored.
std::vector<std::string> trusted_plugin_folders();

/// Loads a plugin (graph/types/plugin.h) and adds its types to the registry. The library stays
/// open.
/// @param file   path of the plugin
/// @param files  plugins loaded so far; the plugin's node types are added. A file in it is not
///   loaded again
/// @throws Failure if the file is not a plugin, was built for another version of fluidcarve, uses
///   names outside of its family, or throws; registry and files are then unchanged
void load_plugin(const std::string& file, Registry& registry, PluginFiles& files);

/// Loads the plugins that a pipeline names, if they are trusted. A relative path starts at the
/// folder of the text that states it, else at the current folder, else at a trusted folder. None
/// outside of --confine is loaded, trusted or not.
/// @param paths     list of paths, or null
/// @param problems  receives a problem with the remedy for each plugin that is not loaded
void load_plugins(const Value& paths, const PluginTrust& trust, Registry& registry,
                  PluginFiles& files, Problems& problems);

}  // namespace fluidcarve
