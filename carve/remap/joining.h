#pragma once

#include "carve/base/values.h"
#include "carve/seam/seams.h"
#include "carve/seam/smooth_displacement.h"

#include <array>
#include <utility>

namespace fluidcarve {

/// How both sides of a seam meet.
enum class Join {
    cut,      ///< whole vertices are taken and added
    squeeze,  ///< the space around each seam is squeezed or stretched
    fade,     ///< both sides are blended (Joins)
};

template <>
struct ChoiceNames<Join> {
    static constexpr std::array names = {std::pair{"cut", Join::cut},
                                         std::pair{"squeeze", Join::squeeze},
                                         std::pair{"fade", Join::fade}};
};

/// The user's parameters for how both sides of seams meet (meanings: pipelines/NODES.md).
struct JoinParams {
    Auto<Join> join;
    Auto<double> fade;
    Auto<double> soft;
    double soft_time = 0;
};

/// How the displacements of a seam set are smoothed, and how its sides are joined.
/// @throws Failure if `soft` is wider than the lattice, or `fade` wider than the room between two
///   joins
Softness softness_of(const JoinParams& params, const Seams& seams);

/// How content changes from one source frame to the next at a seam of frames.
struct TimeJoin {
    int fade = 1;        ///< the window F of METHOD 12 "Seams of frames", frames; 1: a cut
    bool moved = false;  ///< true: moments between frames are shown, moved along the flow; false:
                         ///< both sides are blended
};
/// @param thick  as of Seams
/// @throws Failure if `soft_time` is stated
TimeJoin time_join_of(const JoinParams& params, bool thick);

}  // namespace fluidcarve
