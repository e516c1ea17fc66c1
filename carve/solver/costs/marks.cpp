#include "carve/solver/costs/marks.h"

#include "carve/base/failure.h"
#include "carve/field/extent.h"
#include "carve/field/leaf_cell.h"
#include "carve/volume/grid_types.h"

#include <fmt/format.h>
#include <tbb/parallel_reduce.h>

namespace fluidcarve {

namespace {

using openvdb::Coord;
using openvdb::MaskTree;

MaskTree active_voxels(const openvdb::GridBase& grid) {
#define FLUIDCARVE_TRY(GridT)                                                \
    if (grid.isType<GridT>())                                                \
        return MaskTree(static_cast<const GridT&>(grid).tree(), false, true, \
                        openvdb::TopologyCopy());
    FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_TRY)
#undef FLUIDCARVE_TRY
    throw Failure(
        fmt::format("grid '{}' is of type {}, which is not a mask; make a mask from a field with "
                    "mask.threshold",
                    grid.getName(), grid.type()));
}

}  // namespace

MaskColumns::MaskColumns(const openvdb::GridBase& mask, const Lattice& lattice, Axis axis)
    : axis_(axis),
      lattice_(lattice),
      transform_(mask.transform()),
      set_(active_voxels(mask)),
      alignment_(align(lattice, transform_)) {
    openvdb::CoordBBox active;
    if (set_.evalActiveVoxelBoundingBox(active)) box_ = {padded(active, 1).min(), active.max()};
}

MaskColumns::Marker::Marker(const MaskColumns& mask)
    : mask_(mask),
      reach_(padded(mask.box_, 1)),
      set_(mask.set_),
      places_(mask.transform_, mask.lattice_, mask.axis_) {}

std::size_t MaskColumns::Marker::operator()(int lateral, int k, std::uint16_t code,
                                            std::span<std::uint16_t> codes) {
    const auto first = vertex_of(mask_.axis_, 0, lateral, k);
    places_.move_to(first);
    const auto among = places_.within(reach_, static_cast<int>(codes.size()));
    const auto& alignment = mask_.alignment_;
    const auto voxel = alignment ? alignment->voxel(first[0], first[1], first[2]) : Coord();
    const auto step = alignment ? alignment->step[static_cast<std::size_t>(mask_.axis_)] : Coord();
    std::size_t count = 0;
    for (int entry = among.first; entry <= among.last; ++entry) {
        const bool set = alignment
                             ? set_.isValueOn(voxel + Coord(entry * step.x(), entry * step.y(),
                                                            entry * step.z()))
                             : set_around(places_(entry));
        if (!set) continue;
        codes[static_cast<std::size_t>(entry)] = code;
        ++count;
    }
    return count;
}

bool MaskColumns::Marker::set_around(const openvdb::Vec3d& at) const {
    const auto low = voxel_below(at);
    if (!mask_.box_.isInside(low)) return false;
    for (int n = 0; n < 8; ++n) {
        const Coord offset(n & 1, n >> 1 & 1, n >> 2 & 1);
        bool beside = true;
        for (int d = 0; d < 3; ++d) beside = beside && (offset[d] == 0 || at[d] > low[d]);
        if (beside && set_.isValueOn(low + offset)) return true;
    }
    return false;
}

std::size_t mark_vertices(const openvdb::GridBase& mask, const Lattice& lattice, Axis axis,
                          std::uint16_t code, std::span<std::uint16_t> codes) {
    const MaskColumns set(mask, lattice, axis);
    if (set.empty()) return 0;
    const auto entries = static_cast<std::size_t>(lattice.shape[dimension(axis)]),
               laterals = static_cast<std::size_t>(lattice.shape[lateral_dimension(axis)]);
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, codes.size() / entries, 16), std::size_t{0},
        [&](const tbb::blocked_range<std::size_t>& range, std::size_t count) {
            MaskColumns::Marker mark(set);
            for (auto column = range.begin(); column < range.end(); ++column)
                count +=
                    mark(static_cast<int>(column % laterals), static_cast<int>(column / laterals),
                         code, codes.subspan(column * entries, entries));
            return count;
        },
        std::plus<>());
}

std::vector<std::string> mask_warnings(const MarkCounts& marks) {
    std::vector<std::string> out;
    const auto look = [&](const char* name, const std::optional<std::size_t>& marked,
                          const std::optional<MissedRange>& missed) {
        if (marked == std::size_t{0})
            out.push_back(
                fmt::format("`{}` is set around no vertex of the lattice: nothing is {}ed{}", name,
                            name, missed ? "; its " + to_text(*missed) : std::string()));
    };
    look("protect", marks.protect, marks.protect_missed);
    look("attract", marks.attract, marks.attract_missed);
    return out;
}

}  // namespace fluidcarve
