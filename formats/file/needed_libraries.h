#pragma once

#include <string>
#include <vector>

namespace fluidcarve {

/// The libraries that a shared library needs, also through others: each after those that it needs
/// itself. Left out are those that are open already, and those in folders that no open library is
/// in. Linux only: the file is read as ELF (System V ABI, "Dynamic Section").
/// @return their paths; none if the file can't be read as a library
std::vector<std::string> needed_libraries(const std::string& path);

}  // namespace fluidcarve
