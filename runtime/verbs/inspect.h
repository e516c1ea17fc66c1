#pragma once

#include "graph/types/registry.h"

#include <cstdint>
#include <string>
#include <vector>

namespace fluidcarve {

/// The verb `inspect`: reads each file in a child process, prints its content to stdout, and errors to stderr.
/// @param memory  limit of the memory for reading one file, bytes
/// @return an exit code
int inspect_files(const std::vector<std::string>& paths, bool json, std::uint64_t memory, const Registry& registry);

}  // namespace fluidcarve
