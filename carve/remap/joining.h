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
    fade,     ///< both sides are faded into each other (Joins)
};

template <>
struct ChoiceNames<Join> {
    static constexpr std::array names = {std::pair{"cut", Join::cut},
                                         std::pair{"squeeze", Join::squeeze},
                                         std::pair{"fade", Join::fade}};
};

/// How both sides of seams meet, as it is wished for (pipelines/NODES.md says what each means).
struct JoinParams {
    Auto<Join> join;
    Auto<double> fade;
    Auto<double> soft;
    double soft_time = 0;
};

/// How the displacements of a seam set are smoothed, and how its sides are joined.
/// @throws Failure if `soft` or `fade` is wider than the lattice has room for
Softness softness_of(const JoinParams& params, const Seams& seams);

/// How places go over from one frame to another, if seams are seams of frames.
struct TimeJoin {
    int fade = 1;        ///< frames; 1: at once
    bool moved = false;  ///< by moments between, along the flow; false: both sides are blended
};
/// @param thick  as of Seams
/// @throws Failure if `soft_time` is stated
TimeJoin time_join_of(const JoinParams& params, bool thick);

}  // namespace fluidcarve
