#pragma once

#include "carve/volume/volume.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace fluidcarve::test {

/// `value(world position of the centre)` at each voxel of a box, in cubic voxels.
template <class Grid, class Value>
typename Grid::Ptr sampled(const openvdb::CoordBBox& box, double voxel, const Value& value) {
    const auto out = Grid::create();
    out->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
    out->setName("sampled");
    auto accessor = out->getAccessor();
    for (auto at = box.begin(); at; ++at)
        accessor.setValue(*at, value(out->indexToWorld((*at).asVec3d())));
    return out;
}

/// The same for a staggered velocity: component c stands on its face.
template <class Value>
VectorGrid::Ptr sampled_staggered(const openvdb::CoordBBox& box, double voxel, const Value& value) {
    const auto out = sampled<VectorGrid>(box, voxel, [&](const openvdb::Vec3d& at) {
        openvdb::Vec3s faces;
        for (int c = 0; c < 3; ++c) {
            auto face = at;
            face[c] -= 0.5 * voxel;
            faces[c] = value(face)[c];
        }
        return faces;
    });
    out->setGridClass(openvdb::GRID_STAGGERED);
    return out;
}

/// The largest difference between a grid and `wanted(world position)` in a box; of vectors, the
/// largest length.
template <class Grid, class Wanted>
double largest_error(const Grid& grid, const openvdb::CoordBBox& box, const Wanted& wanted) {
    double out = 0;
    for (auto at = box.begin(); at; ++at) {
        const typename Grid::ValueType error =
            grid.tree().getValue(*at) - wanted(grid.indexToWorld((*at).asVec3d()));
        if constexpr (std::is_arithmetic_v<typename Grid::ValueType>)
            out = std::max(out, static_cast<double>(std::abs(error)));
        else out = std::max(out, static_cast<double>(error.length()));
    }
    return out;
}

/// The velocity of a rigid rotation: its curl is 2 omega.
inline openvdb::Vec3s rotation(const openvdb::Vec3d& omega, const openvdb::Vec3d& at) {
    return openvdb::Vec3s(omega.cross(at));
}

/// A smooth field that differs in all directions, 0 to 4.
inline float swirl(const openvdb::Vec3d& at) {
    return static_cast<float>(2 + std::sin(0.3 * at.x() + 0.2 * at.y()) +
                              std::cos(0.25 * at.z() - 0.4 * at.x()));
}

inline Volume volume_of(const openvdb::GridBase::ConstPtr& grid) {
    Volume out;
    out.grids = {grid};
    return out;
}

/// The sum of the active values of a FloatGrid.
inline double sum(const openvdb::GridBase& grid) {
    double out = 0;
    for (auto value = static_cast<const FloatGrid&>(grid).cbeginValueOn(); value; ++value)
        out += *value;
    return out;
}

}  // namespace fluidcarve::test
