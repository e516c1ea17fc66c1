#pragma once

#include "nodes/payloads.h"
#include "nodes/seams/carve_map.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// A rim of a lattice that content crosses: what the carve moves on one side stays on the other (METHOD 4 "Tears").
struct Tear {
    std::string grid;
    std::string rim;   ///< "v = 0"
    bool faded_away;   ///< whether CarveMap::fade would cure it: not at the far end of a carved axis
    double share = 0;  ///< of the rim's vertices, 0 to 1
};

/// Finds them for the density of a volume; if it has no grid of that name, for all its float and double grids. (Shadow or
/// temperature often fill the whole domain, and cross every rim.) Content crosses a rim at one of its vertices if what the carve
/// brings there comes from elsewhere and is active in the input, and so is the voxel that in the input lay beyond the rim
/// from it, a vertex away; both with values other than the background. Rims: both lateral ones, the ends of an open
/// lattice, and the far end of the carved axis, where content beyond stays while what was inside is moved, freed or added.
/// Of large rims a grid of some thousand vertices is looked at.
/// @param volume  before the carve
std::vector<Tear> find_tears(const Volume& volume, const Lattice& lattice, const CarveMap& map);

/// What to tell of a tear. Shares are told in steps of ten, so that frames that are much alike say the same.
std::string to_text(const Tear& tear);

}  // namespace fluidcarve
