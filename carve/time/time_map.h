#pragma once

#include "carve/lattice/lattice.h"
#include "carve/lattice/mapping.h"
#include "carve/seam/carve_step.h"
#include "carve/seam/seams.h"
#include "carve/time/sequence.h"
#include "carve/volume/volume.h"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace fluidcarve {

/// How seams of frames are carved from a sequence (METHOD 12 "Seams of frames"): of each place,
/// frames leave or are shown twice, each at its own moment. The lattice stands still. What lies
/// beyond a box goes along with its nearest vertex, what lies outside of other lattices with most
/// of their vertices.
class TimeMap {
public:
    /// @param seams  of Axis::t
    /// @param count  of them, from the first on
    /// @param fade   frames in which a place goes over from one frame to another; 1: at once, and
    ///   every place is that of its nearest vertex. It is shorter towards the sequence's ends.
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
        int place = 0;             ///< index in the source
        std::vector<float> share;  ///< `[i][k][j]`, at the vertices, 0 to 1
        float outside = 0;         ///< share outside the lattice, 0 or 1
    };
    /// The vertices around a place, and how much each counts.
    struct Corners {
        std::array<std::size_t, 8> vertex;
        std::array<float, 8> weight;
    };

    /// All that are seen in a frame of the result. Their shares add up to 1 everywhere.
    std::vector<Seen> seen(int n) const;
    /// The place in the source that a vertex shows, without a fade.
    int source_of(std::size_t vertex, int n) const;
    /// Nothing outside the lattice.
    std::optional<Corners> corners_at(const openvdb::Vec3d& world, bool nearest) const;

    std::vector<CarveStep> steps_;  ///< `[i]`
    std::array<int, 3> shape_;      ///< I, J, K
    Mapping mapping_;
    int frames_, source_frames_, fade_;
    bool closed_, around_;
};

}  // namespace fluidcarve
