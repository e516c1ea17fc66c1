#pragma once

#include "graph/types/outlook.h"

#include <string>

namespace fluidcarve {

/// What is wrong, before a run, with where an energy and its lattice lie; empty: nothing.
/// @param energy   where the files have voxels that the energy is made of
/// @param lattice  null: not known
std::string placement_fault(const Region& energy, const Region* lattice);

}  // namespace fluidcarve
