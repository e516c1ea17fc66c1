#pragma once

#include "nodes/payloads.h"
#include "nodes/preview/view.h"

#include <vector>

namespace fluidcarve {

/// One value of a grid for each line of sight, in cells of `cell` x `cell` voxels (0 is a cell's lower border).
struct Projection {
    /// Which of all values in a cell's sight it shows; `largest` is the one of largest size, with its sign.
    enum class Keep { greatest, largest };

    int cell = 1;
    Area cells;                 ///< in cells
    std::vector<float> values;  ///< rows from the bottom up; NaN: nothing active there
    Keep keep = Keep::greatest;

    bool empty() const { return values.empty(); }
    float at(int right, int up) const { return values[place(right, up)]; }
    /// Takes notice of a value in a cell; of NaN it takes none.
    void see(int right, int up, float value);
    /// The same for the voxel with these index coordinates.
    void see(const openvdb::Coord& voxel, View view, float value);

private:
    std::size_t place(int right, int up) const { return static_cast<std::size_t>(up - cells.first[1]) * cells.size(0) + (right - cells.first[0]); }
};

/// Nothing seen yet in the face of an index box.
/// @param box   at least one voxel large
/// @param most  cells that the picture may have on a side; a larger box is seen through cells of 2, 4, ... voxels
Projection blank_projection(const openvdb::CoordBBox& box, View view, int most, Projection::Keep keep = Projection::Keep::greatest);

/// Maximum projection of the active values (of a vector grid: of their lengths) in an index box; NaN values are passed over.
/// @param box, most  as in blank_projection
Projection maximum_projection(const FloatGrid& grid, View view, const openvdb::CoordBBox& box, int most = 1024);
Projection maximum_projection(const VectorGrid& grid, View view, const openvdb::CoordBBox& box, int most = 1024);

/// The same in cells of `cell` voxels, a multiple of the projection's own, over an area in such cells.
Projection fitted(const Projection& projection, int cell, const Area& cells);

}  // namespace fluidcarve
