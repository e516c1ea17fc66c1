#pragma once

#include "graph/types/registry.h"

#include <cstdint>
#include <string>
#include <vector>

namespace fluidcarve {

/// The verb `inspect`: says on stdout what is in each file, read in a process of its own, and on stderr which can't be read.
/// @param memory  bytes that reading one file may take
/// @return an exit code
int inspect_files(const std::vector<std::string>& paths, bool json, std::uint64_t memory, const Registry& registry);

}  // namespace fluidcarve
