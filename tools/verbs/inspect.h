#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace fluidcarve {

/// The verb `inspect`: reads files in child processes, prints their content to stdout, a sequence
/// as one, and errors to stderr.
/// @param paths   files, paths with frame tokens, and folders, of which the files right in them are
///   looked at
/// @param memory  limit of the memory for reading files, bytes
/// @return an exit code
int inspect_files(const std::vector<std::string>& paths, bool json, std::uint64_t memory);

}  // namespace fluidcarve
