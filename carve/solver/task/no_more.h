#pragma once

#include "carve/solver/search/find_seams.h"
#include "carve/solver/task/space.h"
#include "carve/solver/task/task.h"

#include <string>

namespace fluidcarve {

/// Where the next seam finds no way: "window [0, 7]: in frame 6 column ... has no unprotected
/// vertex left".
/// @param part  the part of the task that was searched
std::string where_no_more(const NoSeam& none, const SeamTask& task, const SeamPart& part,
                          const CarvedSpace& space);

/// The message of a failure: how many seams are possible, and where the next one finds no way.
std::string why_no_more(const NoSeam& none, const SeamTask& task, const SeamPart& part,
                        const CarvedSpace& space);

}  // namespace fluidcarve
