#pragma once

#include "nodes/payloads.h"
#include "nodes/seams/carve_map.h"

#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// What is done to carved grids beyond copying and interpolating values (METHOD 5).
struct Finish {
    std::optional<bool> renormalize;     ///< level sets; nothing: where the lattice's vertices are not voxels
    std::vector<std::string> densities;  ///< grids that keep their mass
    bool transform_vectors = false;      ///< all grids of float vectors, also those in three parts
};

/// @param source  what was carved
/// @param carved  its grids after carve_volume, in the same order
/// @throws Failure if a grid of `densities` is not there or no density; if renormalising is demanded of a level set for
///   which it can't be done
Volume finished(const Volume& source, const Volume& carved, const Lattice& lattice, const CarveMap& map, const Finish& finish);

}  // namespace fluidcarve
