#pragma once

#include <cstdint>
#include <string>

namespace fluidcarve {

/// The verb `explain`: reads in a child process what a file states of how it was made, and prints
/// it to stdout, errors to stderr.
/// @param memory  limit of the memory for reading the file, bytes
/// @return an exit code: `input` if the file can't be read, or states nothing
int explain_file(const std::string& path, bool json, std::uint64_t memory);

}  // namespace fluidcarve
