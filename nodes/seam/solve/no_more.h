#pragma once

#include "nodes/seam/search/find_seams.h"
#include "nodes/seam/solve/space.h"
#include "nodes/seam/solve/task.h"

#include <string>

namespace fluidcarve {

/// The message of a failure: how many seams are possible, and where the next one finds no way.
/// @param part  of the task, whose seams were looked for
std::string why_no_more(const NoSeam& none, const SeamTask& task, const SeamTask::Part& part, const CarvedSpace& space);

}  // namespace fluidcarve
