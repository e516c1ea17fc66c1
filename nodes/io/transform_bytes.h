#pragma once

#include "nodes/io/binary.h"

#include <openvdb/math/Transform.h>

namespace fluidcarve {

/// A transform of any kind, to the last bit.
void write_transform(const openvdb::math::Transform& transform, BinaryWriter& to);
/// @throws Failure where write_transform has not written
openvdb::math::Transform::Ptr read_transform(BinaryReader& from);

}  // namespace fluidcarve
