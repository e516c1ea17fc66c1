#pragma once

#include "carve/base/values.h"
#include "carve/lattice/lattice.h"
#include "carve/lattice/mapping.h"
#include "carve/seam/carve_step.h"
#include "carve/seam/seams.h"
#include "carve/time/sequence.h"
#include "carve/volume/volume.h"

#include <cstddef>
#include <vector>

namespace fluidcarve {

/// What seams of frames do to a sequence, as far as it is known before they are found.
struct FramesCarved {
    Count count;          ///< of frames: removed below 0, else inserted
    bool paired = false;  ///< what leaves comes back in another window

    /// The frames that the carve leaves, numbered on from the first.
    /// @param used    number of seams of these that are carved, its sign left out; auto: all
    /// @param frames  of the sequence, rising
    /// @throws Failure if all frames would leave, or if frames are missing between others
    std::vector<int> left(const Auto<Count>& used, const std::vector<int>& frames) const;
};

/// How seams of frames are carved from a sequence (METHOD 12 "Seams of frames"): of each place,
/// frames leave or are shown twice, each at its own moment. The lattice stands still. What lies
/// outside of it shows the frame that most of its vertices show.
class TimeMap {
public:
    /// @param seams  of Axis::t
    /// @param count  of them, from the first on
    /// @param fade   frames in which a place goes over from one frame to another; 1: at once, and
    ///   every place is that of its nearest vertex
    /// @throws Failure if the set is not of this lattice, or not of frames, or holds fewer seams
    TimeMap(const Seams& seams, const Lattice& lattice, std::size_t count, int fade);

    int frames() const { return frames_; }  ///< after the carve
    /// A frame of the result.
    /// @param source  the frames of Seams::frames
    /// @param n       from 0 to frames() - 1
    Volume frame(const Sequence& source, int n) const;

private:
    /// A frame of the source that is seen in one of the result.
    struct Seen {
        int place;                 ///< index in the source
        std::vector<float> share;  ///< `[i][k][j]`, at the vertices, 0 to 1
        float outside = 0;         ///< share outside the lattice, 0 or 1
    };
    /// All that are seen in a frame of the result. Their shares add up to 1 everywhere.
    std::vector<Seen> seen(int n) const;
    /// The place in the source that a vertex shows, without a fade.
    int source_of(std::size_t i, int j, int k, int n) const;
    float share_at(const Seen& seen, const openvdb::Vec3d& world) const;

    std::vector<CarveStep> steps_;  ///< `[i]`
    std::array<int, 3> shape_;      ///< I, J, K
    Mapping mapping_;
    int frames_, source_frames_, fade_;
    bool closed_, around_;
};

}  // namespace fluidcarve
