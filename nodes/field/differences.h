#pragma once

#include <openvdb/openvdb.h>

namespace fluidcarve {

// For map_stencil. Not tools::gradient and tools::curl: those take a staggered grid for a collocated one, and the corner of an
// active tile for all of it.

/// What a field's neighbours differ by along x, y and z: its gradient, times two voxels.
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
