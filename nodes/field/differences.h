#pragma once

#include <openvdb/openvdb.h>

namespace fluidcarve {

// Operators for map_stencil. tools::gradient and tools::curl are not used: they treat staggered grids as collocated, and evaluate
// an active tile only at its corner.

/// Differences of the neighbours along x, y and z: the gradient, times two voxels.
template <class Accessor>
openvdb::Vec3s gradient_differences(Accessor& field, const openvdb::Coord& at) {
    return {field.getValue(at.offsetBy(1, 0, 0)) - field.getValue(at.offsetBy(-1, 0, 0)),
            field.getValue(at.offsetBy(0, 1, 0)) - field.getValue(at.offsetBy(0, -1, 0)),
            field.getValue(at.offsetBy(0, 0, 1)) - field.getValue(at.offsetBy(0, 0, -1))};
}

/// The curl of a collocated vector field, times two voxels.
template <class Accessor>
openvdb::Vec3s curl_differences(Accessor& vectors, const openvdb::Coord& at) {
    const openvdb::Vec3s dx = vectors.getValue(at.offsetBy(1, 0, 0)) - vectors.getValue(at.offsetBy(-1, 0, 0));
    const openvdb::Vec3s dy = vectors.getValue(at.offsetBy(0, 1, 0)) - vectors.getValue(at.offsetBy(0, -1, 0));
    const openvdb::Vec3s dz = vectors.getValue(at.offsetBy(0, 0, 1)) - vectors.getValue(at.offsetBy(0, 0, -1));
    return {dy[2] - dz[1], dz[0] - dx[2], dx[1] - dy[0]};
}

}  // namespace fluidcarve
