#pragma once

#include "carve/volume/volume.h"
#include "nodes/preview/view.h"

#include <vector>

namespace fluidcarve {

/// A projection of a grid: one value per cell of `cell` x `cell` voxels. Cell 0 begins at voxel 0.
struct Projection {
    /// Which value along its lines of sight a cell shows: the greatest, or the one of largest
    /// magnitude, with its sign.
    enum class Keep { greatest, largest };

    int cell = 1;               ///< size of a cell, voxels
    Area cells;                 ///< the projected area, in cells
    std::vector<float> values;  ///< `[up][right]`; NaN: no active voxel
    Keep keep = Keep::greatest;

    bool empty() const { return values.empty(); }
    float at(int right, int up) const { return values[place(right, up)]; }
    /// Adds a value to a cell. NaN is ignored.
    void see(int right, int up, float value);
    /// The same for the voxel with these index coordinates.
    void see(const openvdb::Coord& voxel, View view, float value);

private:
    std::size_t place(int right, int up) const {
        return static_cast<std::size_t>(up - cells.first[1]) * cells.size(0) +
               (right - cells.first[0]);
    }
};

/// An empty projection of an index box.
/// @param box   not empty
/// @param most  maximum number of cells on a side; a larger box gets cells of 2, 4, ... voxels
Projection blank_projection(const openvdb::CoordBBox& box, View view, int most,
                            Projection::Keep keep = Projection::Keep::greatest);

/// Maximum projection of the active values in an index box; for vectors, of their lengths. NaN is
/// ignored.
/// @param box, most  as in blank_projection
Projection maximum_projection(const FloatGrid& grid, View view, const openvdb::CoordBBox& box,
                              int most = 1024);
Projection maximum_projection(const VectorGrid& grid, View view, const openvdb::CoordBBox& box,
                              int most = 1024);

/// A projection converted to larger cells and another area.
/// @param cell   new size of a cell, voxels; a multiple of the projection's
/// @param cells  the new area, in new cells
Projection fitted(const Projection& projection, int cell, const Area& cells);

}  // namespace fluidcarve
