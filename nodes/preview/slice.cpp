#include "nodes/preview/slice.h"

#include "carve/base/failure.h"
#include "carve/field/extent.h"
#include "carve/field/same_transform.h"

#include <fmt/format.h>

namespace fluidcarve {

namespace {

/// The index box in space `to` that contains an index box of space `from`.
openvdb::CoordBBox box_in(const openvdb::CoordBBox& box, const openvdb::math::Transform& from,
                          const openvdb::math::Transform& to) {
    const auto half = openvdb::Vec3d(0.5);
    const auto world =
        from.indexToWorld(openvdb::BBoxd(box.min().asVec3d() - half, box.max().asVec3d() + half));
    const auto index = to.worldToIndex(world);
    const auto low = voxel_at(index.min()), high = voxel_at(index.max());
    if (!low || !high)
        throw Failure(fmt::format(
            "the energy lies too far from the grid that is shown, with {}; compare their units",
            place_text(to)));
    return {*low, *high};
}

}  // namespace

openvdb::CoordBBox slice_of(const openvdb::CoordBBox& box, View view, int plane) {
    const auto axis = static_cast<int>(view);
    if (box.empty() || plane < box.min()[axis] || plane > box.max()[axis]) return {};
    auto out = box;
    out.min()[axis] = out.max()[axis] = plane;
    return out;
}

Projection slice_in(const FloatGrid& grid, const openvdb::math::Transform& space, View view,
                    int plane, int most) {
    const auto active = grid.evalActiveVoxelBoundingBox();
    if (active.empty()) return {};
    const bool same = grid.transform() == space;
    const auto box = slice_of(same ? active : box_in(active, grid.transform(), space), view, plane);
    if (box.empty()) return {};
    if (same) return maximum_projection(grid, view, box, most);

    constexpr std::uint64_t most_voxels = std::uint64_t{1} << 32;
    if (voxels_in(box) > most_voxels)
        throw Failure(fmt::format(
            "a slice of grid '{}' spans {} of the grid that is shown; {} is the most: crop it",
            grid.getName(), span_text(box), most_voxels));
    auto out = blank_projection(box, view, most);
    const auto values = grid.getConstAccessor();
    for (auto at = box.begin(); at; ++at) {
        float value = 0;
        const auto voxel = voxel_at(grid.worldToIndex(space.indexToWorld(*at)));
        if (voxel && values.probeValue(*voxel, value)) out.see(*at, view, value);
    }
    return out;
}

}  // namespace fluidcarve
