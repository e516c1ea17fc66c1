#pragma once

#include "carve/base/failure.h"

#include <cstddef>
#include <string>

namespace fluidcarve {

/// What to throw if there is no room for such a file. @param code  the system's error
Failure no_room_for_scratch(const std::string& folder, const std::string& what, std::size_t bytes,
                            int code);

/// Creates an unnamed file in a folder. It disappears when it is closed. Its space is allocated at
/// once: otherwise a full disk would kill the process later, without a message.
/// @param folder  created if missing
/// @param what    the file's content, for messages: "energies, seams or displacements"
/// @return the descriptor, which the caller closes
/// @throws Failure if there is no room
int scratch_file(const std::string& folder, const std::string& what, std::size_t bytes);

}  // namespace fluidcarve
