#pragma once

#include "carve/seam/seams.h"

#include <string>

namespace fluidcarve {

/// A checksum of all that a seam file holds of seams or a warp, however it stores it: `xxh3-128:`
/// and 32 hex digits. Lower bounds do not count, since files do not hold them. pipelines/FORMATS.md
/// says what is hashed, and in which order.
std::string seam_checksum(const Seams& seams);

}  // namespace fluidcarve
