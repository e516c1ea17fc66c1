#include "nodes/seam/energy/marks.h"

#include "graph/text/problem.h"
#include "nodes/field/extent.h"
#include "nodes/field/leaf_cell.h"
#include "nodes/grid_types.h"
#include "nodes/lattice/alignment.h"
#include "nodes/seam/energy/column_places.h"

#include <fmt/format.h>
#include <tbb/parallel_reduce.h>

#include <functional>

namespace fluidcarve {

namespace {

using openvdb::Coord;
using openvdb::MaskTree;

MaskTree active_voxels(const openvdb::GridBase& grid) {
#define FLUIDCARVE_TRY(GridT) \
    if (grid.isType<GridT>()) return MaskTree(static_cast<const GridT&>(grid).tree(), false, true, openvdb::TopologyCopy());
    FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_TRY)
#undef FLUIDCARVE_TRY
    throw Failure(fmt::format("grid '{}' is of type {}, which is not a mask; make a mask from a field with mask.threshold", grid.getName(), grid.type()));
}

/// Tells whether a mask is set around the vertices of a column.
class Around {
public:
    /// @param box  of the mask's active voxels
    Around(const MaskTree& mask, const openvdb::CoordBBox& box, const openvdb::math::Transform& transform, const Lattice& lattice,
           const std::optional<Alignment>& alignment, Axis axis)
        : mask_(mask), box_(padded(box, 1).min(), box.max()), places_(transform, lattice, axis), alignment_(alignment), axis_(axis) {}

    void move_to(const std::array<int, 3>& first) {
        if (alignment_) first_ = alignment_->voxel(first[0], first[1], first[2]);
        else places_.move_to(first);
    }
    bool operator()(int entry) {
        if (alignment_) {
            const auto& step = alignment_->step[static_cast<std::size_t>(axis_)];
            return mask_.isValueOn(first_ + Coord(entry * step.x(), entry * step.y(), entry * step.z()));
        }
        const auto at = places_(entry);
        const auto low = voxel_below(at);
        if (!box_.isInside(low)) return false;
        for (int n = 0; n < 8; ++n) {
            const Coord offset(n & 1, n >> 1 & 1, n >> 2 & 1);
            bool beside = true;
            for (int d = 0; d < 3; ++d) beside = beside && (offset[d] == 0 || at[d] > low[d]);
            if (beside && mask_.isValueOn(low + offset)) return true;
        }
        return false;
    }

private:
    openvdb::tree::ValueAccessor<const MaskTree> mask_;
    const openvdb::CoordBBox box_;  ///< of the lowest of the 8 voxels around a vertex, if any of them may be set
    ColumnPlaces places_;
    const std::optional<Alignment>& alignment_;
    const Axis axis_;
    Coord first_;
};

}  // namespace

std::size_t mark_vertices(const openvdb::GridBase& mask, const Lattice& lattice, Axis axis, std::uint16_t code, std::span<std::uint16_t> codes,
                          std::optional<Planes> planes) {
    const auto these = planes.value_or(Planes{0, lattice.shape[2]});
    const auto set = active_voxels(mask);
    openvdb::CoordBBox box;
    if (!set.evalActiveVoxelBoundingBox(box)) return 0;
    const auto alignment = align(lattice, mask.transform());
    const int entries = lattice.shape[dimension(axis)], laterals = lattice.shape[lateral_dimension(axis)];
    return tbb::parallel_reduce(
        tbb::blocked_range<int>(0, these.count * laterals, 16), std::size_t{0},
        [&](const tbb::blocked_range<int>& range, std::size_t count) {
            Around around(set, box, mask.transform(), lattice, alignment, axis);
            auto out = codes.begin() + static_cast<std::ptrdiff_t>(range.begin()) * entries;
            for (int column = range.begin(); column < range.end(); ++column) {
                around.move_to(vertex_of(axis, 0, column % laterals, these.first + column / laterals));
                for (int entry = 0; entry < entries; ++entry, ++out)
                    if (around(entry)) {
                        *out = code;
                        ++count;
                    }
            }
            return count;
        },
        std::plus<>());
}

}  // namespace fluidcarve
