#pragma once

#include "carve/seam/carve_map.h"
#include "carve/volume/volume.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// A rim of a lattice that content crosses: the carve moves the content on one side only (METHOD 4
/// "Tears").
struct Tear {
    std::string grid;
    std::string rim;  ///< for example "v = 0"
    /// Whether CarveMap::fade_rims would prevent it: not at the ends of a carved axis.
    bool faded_away;
    double share = 0;  ///< of the rim's vertices, 0 to 1
};

/// Finds the tears of a volume's density; if no grid has that name, of all its float and double
/// grids. (Shadow or temperature often fill the whole domain and cross every rim.) Content crosses
/// a rim at a vertex if the carve moves the vertex's content and two voxels of the input are
/// active: the content's source, and the one a vertex beyond the rim from it. Both values must
/// differ from the background. Rims are both lateral ones, the ends of an open lattice, and the
/// far end of the carved axis, where content beyond stays while content inside is moved, freed or
/// added. Of a large rim, some thousand vertices at regular distances are checked.
/// @param volume  before the carve
std::vector<Tear> find_tears(const Volume& volume, const Lattice& lattice, const CarveMap& map);

/// A warning about a tear. It rounds shares to powers of ten, so that similar frames give the same
/// warning.
std::string to_text(const Tear& tear);

}  // namespace fluidcarve
