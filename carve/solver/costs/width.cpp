#include "carve/solver/costs/width.h"

#include "carve/base/median.h"
#include "carve/field/extent.h"
#include "carve/field/shown_part.h"

#include <openvdb/tools/Interpolation.h>
#include <tbb/parallel_for.h>

#include <cstddef>
#include <utility>
#include <vector>

namespace fluidcarve {

int width_in(const FloatGrid& grid, const Lattice& lattice, Axis axis) {
    const ShownPart shown(grid);
    const auto entries = lattice.shape[dimension(axis)],
               laterals = lattice.shape[lateral_dimension(axis)],
               slices = lattice.shape[slice_dimension(axis)];
    std::vector<int> widths(static_cast<std::size_t>(slices));
    tbb::parallel_for(0, slices, [&](int slice) {
        const auto accessor = grid.getConstAccessor();
        const openvdb::tools::GridSampler<FloatGrid::ConstAccessor, openvdb::tools::BoxSampler>
            values(accessor, grid.transform());
        const auto shows = [&](int entry, int lateral) {
            const auto vertex = vertex_of(axis, entry, lateral, slice);
            return shown(values.isSample(near_place(grid.worldToIndex(
                lattice.position(openvdb::Vec3d(vertex[0], vertex[1], vertex[2]))))));
        };
        for (int entry = 0; entry < entries; ++entry) {
            bool any = false;
            for (int lateral = 0; lateral < laterals && !any; ++lateral)
                any = shows(entry, lateral);
            widths[static_cast<std::size_t>(slice)] += any ? 1 : 0;
        }
    });
    std::erase(widths, 0);
    if (widths.empty()) return 0;
    return median_of(std::move(widths));
}

}  // namespace fluidcarve
