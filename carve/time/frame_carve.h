#pragma once

#include "carve/base/limits.h"
#include "carve/points/points.h"
#include "carve/remap/joining.h"
#include "carve/stream/mesh_stream.h"
#include "carve/stream/points_stream.h"
#include "carve/time/frame_list.h"
#include "carve/time/motions.h"
#include "carve/time/sequence.h"
#include "carve/time/time_map.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace fluidcarve {

/// Carves seams of frames from a sequence of volumes, points or meshes that is gathered frame by
/// frame (TimeMap).
class FrameCarve {
public:
    /// Adds a frame. @param number  of the frame, above those before
    /// @throws Failure if the lattice differs from that of the frames before
    void add(const Volume& source, const Ref<Lattice>& lattice, int number, const Limits& limits);
    void add(const Ref<Points>& source, const Ref<Lattice>& lattice, int number,
             const Limits& limits);
    void add(const Ref<Mesh>& source, const Ref<Lattice>& lattice, int number,
             const Limits& limits);
    const std::vector<int>& numbers() const { return numbers_; }  ///< of the frames added

    /// Call it once all frames are added.
    /// @param count  of the seams, from the first on
    /// @param left   numbers of the frames that the carve leaves (FrameCarvePromise)
    /// @throws Failure if the seams are of other frames, or as TimeMap
    void finish(const Seams& seams, std::size_t count, const std::vector<int>& left,
                const JoinParams& join, std::uint64_t memory_budget);
    /// Whether moments between frames can't be moved along a motion: no float grid of volumes
    /// shows one, or the faces of meshes change.
    bool blends() const { return blends_; }
    /// A frame that the carve leaves. May be called from many threads at once.
    /// @param pace  whether velocities are multiplied by the local rate of time
    /// @throws Failure if the carve leaves no frame of this number
    Volume volume(int number, bool pace) const;
    Points points(int number, bool pace) const;
    Mesh mesh(int number) const;

private:
    void require_still(const Ref<Lattice>& lattice);
    int place_of(int number) const;

    Sequence source_;
    NumberedFrames<Points> points_;
    NumberedFrames<Mesh> meshes_;
    bool faces_change_ = false;
    Ref<Lattice> lattice_;
    std::vector<int> numbers_, left_;
    std::optional<TimeMap> map_;
    std::optional<Motions> motions_;
    bool blends_ = false;
};

}  // namespace fluidcarve
