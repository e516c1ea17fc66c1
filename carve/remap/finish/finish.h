#pragma once

#include "carve/seam/carve_map.h"
#include "carve/volume/volume.h"

#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// What to do to carved grids besides copying and interpolating values (METHOD 5).
struct Finish {
    /// Whether level sets are renormalised; nothing: those that can_renormalize().
    std::optional<bool> renormalize;
    std::vector<std::string> densities;  ///< names of grids that keep their mass
    /// Whether vectors_turned() is applied to all grids of vectors, also those stored as three
    /// grids, and to the velocities of points.
    bool transform_vectors = false;
};

/// Finishes a carved volume.
/// @param source  the volume before the carve
/// @param carved  its grids after carve_volume(), in the same order
/// @throws Failure if a grid of `densities` is missing or no density; if renormalising is demanded
///   of a level set for which it can't be done
Volume finished(const Volume& source, const Volume& carved, const Lattice& lattice,
                const CarveMap& map, const Finish& finish);

}  // namespace fluidcarve
