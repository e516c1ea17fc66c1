#pragma once

#include "carve/lattice/lattice.h"
#include "carve/lattice/mapping.h"
#include "carve/remap/joining.h"
#include "carve/seam/carve_step.h"
#include "carve/seam/seams.h"
#include "carve/stream/mesh_stream.h"
#include "carve/stream/points_stream.h"
#include "carve/time/frame_list.h"
#include "carve/time/motions.h"
#include "carve/time/paced.h"
#include "carve/time/points_between.h"
#include "carve/time/sequence.h"
#include "carve/volume/volume.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace fluidcarve {

/// The frames of a sequence, and how two of them are mixed.
template <class T>
struct FrameSource {
    std::function<T(std::size_t place)> at;
    /// A moment between the neighbours `a` and `b`, moved along the flow.
    /// @param place   index of `a`
    /// @param second  whether what can't be mixed is that of `b`
    std::function<T(const T& a, const T& b, std::size_t place, const ShareAt& share, bool second)>
        between;
    /// `a` and `b`, blended. @param of_points  the share of points; null: it is the same
    std::function<T(const T& a, const T& b, const ShareAt& share, bool second,
                    const ShareAt& of_points)>
        mixed;
};
/// @param sequence, motions  must outlive the result
FrameSource<Volume> frame_source(const Sequence& sequence, const Motions& motions);
/// The same of points, which go along their velocities.
FrameSource<Points> frame_source(const NumberedFrames<Points>& list);
/// The same of meshes, whose vertices move straight.
FrameSource<Mesh> frame_source(const NumberedFrames<Mesh>& list);

/// Carves seams of frames from a sequence (METHOD 12 "Seams of frames"): at each place, frames are
/// removed or shown twice, at moments of its own. The lattice must not move. Places beyond a box
/// follow its nearest vertex; places outside other lattices follow the median of all vertices.
class TimeMap {
public:
    /// @param seams  of Axis::t
    /// @param count  of them, from the first on
    /// @param join   fades are shorter towards the sequence's ends; with a cut, each place follows
    ///   its nearest vertex
    /// @throws Failure if the set is not of this lattice, or not of frames, or holds fewer seams
    TimeMap(const Seams& seams, const Lattice& lattice, std::size_t count, const TimeJoin& join);

    int frames() const { return frames_; }  ///< after the carve
    /// A frame of the result.
    /// @param source  of volumes, points or meshes, the frames of Seams::frames
    /// @param n       from 0 to frames() - 1
    template <class T>
    T frame(const FrameSource<T>& source, int n) const;
    /// Rate of time in a frame of the result: frames of the source per frame, by world position.
    /// Null: 1 everywhere, since frames are cut or blended, and each side moves at its own speed.
    /// Must not outlive this.
    RateAt rate(int n) const;

private:
    /// A frame of the source that shows in a frame of the result.
    struct Seen {
        int place = 0;             ///< index in the source
        std::vector<float> share;  ///< `[i][k][j]`, at the vertices, 0 to 1
        float outside = 0;         ///< share outside the lattice, 0 or 1
    };
    /// The vertices around a place, and their weights.
    struct Corners {
        std::array<std::size_t, 8> vertex;
        std::array<float, 8> weight;
    };

    /// The moment of the source that each place shows in a frame of the result, in frames: 2.5 is
    /// halfway between its frames 2 and 3.
    struct Moments {
        std::vector<float> at;  ///< `[i][k][j]`, at the vertices
        float outside = 0;      ///< outside the lattice
    };

    template <class T>
    T moved(const FrameSource<T>& source, int n) const;
    template <class T>
    T blended(const FrameSource<T>& source, int n) const;
    Moments moments(int n) const;
    double at(const Moments& moments, const openvdb::Vec3d& world) const;
    /// All source frames that show in a frame of the result. Their shares add up to 1 everywhere.
    std::vector<Seen> seen(int n) const;
    std::size_t vertices() const;
    /// The window F of the fade at a frame of the result, frames.
    int fade_at(int n) const { return std::min({join_.fade, n + 1, frames_ - n}); }
    /// Index of the source frame that a vertex shows in a frame of the result, without a fade.
    int source_of(std::size_t vertex, int n) const;
    /// The same for frame `n + behind`, minus `behind`.
    int source_of(std::size_t vertex, int n, int behind) const;
    /// Nothing outside the lattice.
    std::optional<Corners> corners_at(const openvdb::Vec3d& world, bool nearest) const;

    std::vector<CarveStep> steps_;  ///< `[i]`
    std::array<int, 3> shape_;      ///< I, J, K
    Mapping mapping_;
    int frames_, source_frames_;
    TimeJoin join_;
    bool closed_, around_;
};

}  // namespace fluidcarve
