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

/// Finds claims that write over a file of an earlier claim. Paths that lead to one file through
/// dots or links count as equal, and so does the target of a link that is read.
/// @return per claim: the earliest claim with one of its files; nothing if there is none, or the
///   claim only reads
std::vector<std::optional<std::size_t>> overwritten(const std::vector<FileClaim>& claims,
                                                    const std::vector<int>& frames);

}  // namespace fluidcarve
