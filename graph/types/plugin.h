#pragma once

#include "graph/types/registry.h"

#include <cstddef>

namespace fluidcarve {

/// Version of the binary interface between plugins and the program: the two symbols below, and the
/// headers of graph/. Raise it whenever a type there changes its layout or a function its meaning.
/// Plugins of another version are refused.
inline constexpr int plugin_abi = 10;

/// The same for the headers of nodes/. Raise it whenever Volume, Lattice, Seams, Rig, Points, Mesh,
/// SeamNode or a type inside them changes its layout.
inline constexpr int payload_abi = 13;

/// The header of a plugin, read before any of its code runs. A plugin is a shared library with node
/// types, and perhaps payload types, of its own family; pipelines name its file under `plugins`.
/// The plugin sets only the family:
///
///     const fluidcarve::PluginHeader fluidcarve_plugin{.family = "acme"};
///     void fluidcarve_register(fluidcarve::Registry& out) { out.add(acme::sparkle()); }
struct PluginHeader {
    int abi = plugin_abi;  ///< must stay the first member: it determines the layout of the rest
    int payloads = payload_abi;
    /// Detects another layout of the standard library's types.
    std::size_t node_type = sizeof(NodeType);
    const char* version = FLUIDCARVE_VERSION;  ///< version of fluidcarve at build time
    /// All its types are called `FAMILY.NAME`; no built-in type may have this family.
    const char* family = nullptr;
};

}  // namespace fluidcarve

/// The two symbols of a plugin.
extern "C" {
[[gnu::visibility("default")]] extern const fluidcarve::PluginHeader fluidcarve_plugin;
/// Adds the plugin's types. If it throws, the error is reported and none of its types are added.
[[gnu::visibility("default")]] void fluidcarve_register(fluidcarve::Registry& out);
}
