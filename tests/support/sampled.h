#pragma once

#include "nodes/payloads.h"

namespace fluidcarve::test {

/// `value(world position of the centre)` at each voxel of a box, in cubic voxels.
template <class Grid, class Value>
typename Grid::Ptr sampled(const openvdb::CoordBBox& box, double voxel, const Value& value) {
    const auto out = Grid::create();
    out->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
    out->setName("sampled");
    auto accessor = out->getAccessor();
    for (auto at = box.begin(); at; ++at) accessor.setValue(*at, value(out->indexToWorld((*at).asVec3d())));
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

/// The velocity of a rigid rotation: its curl is 2 omega.
inline openvdb::Vec3s rotation(const openvdb::Vec3d& omega, const openvdb::Vec3d& at) { return openvdb::Vec3s(omega.cross(at)); }

}  // namespace fluidcarve::test
