#pragma once

#include <string>
#include <vector>

namespace fluidcarve {

/// The libraries that a shared library needs, also through others: each after those that it needs
/// itself. Leaves out libraries that are already open, and those in folders without an open
/// library. Linux only: the file is read as ELF (System V ABI, "Dynamic Section").
/// @return their paths; none if the file can't be read as a library
std::vector<std::string> needed_libraries(const std::string& path);

}  // namespace fluidcarve
