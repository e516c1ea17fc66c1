#pragma once

#include "carve/solver/search/columns.h"
#include "carve/solver/search/seam_part.h"
#include "carve/solver/task/params.h"
#include "carve/solver/task/space.h"

#include <array>
#include <optional>
#include <string>

namespace fluidcarve {

/// What a solver has to find, as known before the energy.
struct SeamTask {
    Axis axis = Axis::u;
    std::array<int, 3> shape{};  ///< I, J, K of the space
    int size = 0;                ///< vertices along the axis; for seams of frames, the number of
                                 ///< frames
    int finest = 1;              ///< 2: seams are found at half size
    int asked = 0;               ///< number of seams in each part that the parameters want
    /// Number of seams to find in each part; with `best_effort` no more than there is room for.
    int count = 0;
    std::string limit;  ///< which window is too small, if `count` is below `asked`
    SeamPart seams;
    std::optional<SeamPart> pairs;
};

/// What messages say after "vertices": " once the seams of `after` are carved", or nothing.
/// @param carved  whether other sets have carved the space
std::string once_carved(bool carved);

/// The task that parameters set in a space.
/// @param finest  2: seams are found at half size
/// @throws Failure if the space is empty, if a window or the anchor leaves it, if a window has too
///   little room, if removals leave no vertex along the axis, or as require_ends()
SeamTask task_of(const SolverParams& params, const CarvedSpace& space, int finest = 1);
/// The same before the space is there. @param form  must be known along the axis
/// @param carved  whether other sets have carved the space
SeamTask task_of(const SolverParams& params, const LatticeForm& form, bool carved, int finest = 1);

/// Requires an open axis, or a pair window if the axis is closed. Around a rig, requires the axis
/// u, with the default anchor, or t.
/// @throws Failure
void require_ends(const SolverParams& params, const LatticeForm& form);

/// The columns of the seams of a task.
Columns columns_of(const SeamTask& task, const CarvedSpace& space);

/// The seam set of a task, without seams.
Seams empty_seams(const SolverParams& params, const SeamTask& task, const CarvedSpace& space);

}  // namespace fluidcarve
