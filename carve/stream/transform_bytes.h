#pragma once

#include "carve/stream/binary.h"

#include <openvdb/math/Transform.h>

namespace fluidcarve {

/// Writes a transform of any kind, bit for bit.
void write_transform(const openvdb::math::Transform& transform, BinaryWriter& to);
/// Reads what write_transform wrote. @throws Failure on anything else
openvdb::math::Transform::Ptr read_transform(BinaryReader& from);

}  // namespace fluidcarve
