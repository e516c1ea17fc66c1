#pragma once

#include "carve/field/jacobian.h"

#include <openvdb/openvdb.h>

namespace fluidcarve {

// Operators for map_stencil. tools::gradient and tools::curl are not used: they treat staggered
// grids as collocated, and evaluate an active tile only at its corner.

/// Differences of the neighbours on both sides along each index axis.
template <class Accessor>
openvdb::Vec3s differences_at(Accessor& field, const openvdb::Coord& at) {
    return {field.getValue(at.offsetBy(1, 0, 0)) - field.getValue(at.offsetBy(-1, 0, 0)),
            field.getValue(at.offsetBy(0, 1, 0)) - field.getValue(at.offsetBy(0, -1, 0)),
            field.getValue(at.offsetBy(0, 0, 1)) - field.getValue(at.offsetBy(0, 0, -1))};
}

/// The curl of a collocated vector field, per world unit.
template <class Accessor>
openvdb::Vec3s curl_at(Accessor& vectors, const openvdb::Coord& at, const Jacobian& jacobian) {
    const openvdb::Vec3s dx =
        vectors.getValue(at.offsetBy(1, 0, 0)) - vectors.getValue(at.offsetBy(-1, 0, 0));
    const openvdb::Vec3s dy =
        vectors.getValue(at.offsetBy(0, 1, 0)) - vectors.getValue(at.offsetBy(0, -1, 0));
    const openvdb::Vec3s dz =
        vectors.getValue(at.offsetBy(0, 0, 1)) - vectors.getValue(at.offsetBy(0, 0, -1));
    return jacobian.curl(dx, dy, dz);
}

}  // namespace fluidcarve
