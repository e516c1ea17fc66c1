#pragma once

namespace fluidcarve {

/// Makes OpenVDB know its own types, and those that applications add and that it leaves out. Whoever reads or makes grids of types
/// known by name only calls this first; further calls do nothing.
void register_openvdb_types();

}  // namespace fluidcarve
