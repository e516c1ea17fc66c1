#pragma once

#include "graph/types/registry.h"

#include <cstddef>

namespace fluidcarve {

/// Number of what lies between a plugin and the program: the two symbols below, and everything of graph/ that a plugin is compiled with.
/// To be raised whenever a type there changes its layout or a function its meaning: plugins built before are then refused.
inline constexpr int plugin_abi = 1;

/// The same for the payload types of nodes/ and the functions around them: raised when Volume, Lattice, Seams, Rig, Points, Mesh, SeamNode or what
/// they hold change their layout.
inline constexpr int payload_abi = 2;

/// What a plugin says of itself before any of its code is called. A plugin is a shared library with node types, and payload types
/// if it has any, of a family of its own; pipelines name its file under `plugins`. It states no more than the family:
///
///     const fluidcarve::PluginHeader fluidcarve_plugin{.family = "acme"};
///     void fluidcarve_register(fluidcarve::Registry& out) { out.add(acme::sparkle()); }
struct PluginHeader {
    int abi = plugin_abi;  ///< stays the first member for ever: what follows is of that number
    int payloads = payload_abi;
    std::size_t node_type = sizeof(NodeType);  ///< differs, too, where the compiler lays out the standard library's types another way
    const char* version = FLUIDCARVE_VERSION;  ///< of the fluidcarve that it was built with
    const char* family = nullptr;              ///< its types are `FAMILY.NAME`, and no built-in type is
};

}  // namespace fluidcarve

/// The two symbols of a plugin.
extern "C" {
[[gnu::visibility("default")]] extern const fluidcarve::PluginHeader fluidcarve_plugin;
/// Adds the plugin's types. What it throws is told as the plugin's fault; nothing of it is then added.
[[gnu::visibility("default")]] void fluidcarve_register(fluidcarve::Registry& out);
}
