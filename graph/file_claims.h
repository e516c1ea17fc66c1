#pragma once

#include "formats/file/path_pattern.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace fluidcarve {

/// A file that a pipeline reads or writes, or one for each frame.
struct FileClaim {
    PathPattern path;
    bool writes = false;
};

/// Which claim writes over a file of an earlier one. A file is the same by whatever path: through
/// dots or links, and so is what a link leads to that is read.
/// @return per claim: the earliest with one of its files; nothing if there is none, or it only
///   reads
std::vector<std::optional<std::size_t>> overwritten(const std::vector<FileClaim>& claims,
                                                    const std::vector<int>& frames);

}  // namespace fluidcarve
