#pragma once

#include "graph/text/value.h"
#include "graph/types/registry.h"

#include <map>
#include <string>
#include <vector>

namespace fluidcarve {

/// The files of plugins, by the node types that they declare.
using PluginFiles = std::map<std::string, std::string, std::less<>>;

/// Which plugins a pipeline may load. They are code, which runs with all rights of whoever runs the pipeline.
struct PluginTrust {
    bool all = false;                  ///< `--allow-plugins`
    std::vector<std::string> folders;  ///< what lies below these
};

/// The absolute folders in the environment variable FLUIDCARVE_PLUGINS, between colons.
std::vector<std::string> trusted_plugin_folders();

/// Adds what a plugin declares (graph/types/plugin.h) to the registry. The plugin stays open.
/// @param file   a path
/// @param files  of the plugins so far; its types are added. A file that is among them is not loaded again
/// @throws Failure if it is no plugin, was built for another fluidcarve, takes names that are not its own, or throws itself; registry and
///         files are then what they were
void load_plugin(const std::string& file, Registry& registry, PluginFiles& files);

/// Loads the plugins that a pipeline names, if they may be: relative to the text that states them, else to the current folder, else
/// to a trusted one.
/// @param paths  a list, or null
/// @param problems  of each that is not loaded: why not, and what to do
void load_plugins(const Value& paths, const PluginTrust& trust, Registry& registry, PluginFiles& files, Problems& problems);

}  // namespace fluidcarve
