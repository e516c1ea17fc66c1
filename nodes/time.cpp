#include "nodes/time.h"

#include "carve/base/failure.h"
#include "carve/base/frame_set.h"
#include "carve/stream/mesh_stream.h"
#include "carve/stream/points_stream.h"
#include "carve/time/between.h"
#include "carve/time/frame_list.h"
#include "carve/time/loop.h"
#include "carve/time/mesh_between.h"
#include "carve/time/points_between.h"
#include "carve/time/sequence.h"
#include "carve/time/thumbnails.h"
#include "carve/time/time_surface.h"
#include "graph/types/node_type.h"
#include "nodes/params/one_or_two.h"
#include "nodes/params/pace_params.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

namespace {

/// The surface of surface_between(), or a warning that there is none.
std::optional<TimeSurface> surface_in(const Sequence& source,
                                      const std::vector<std::pair<std::size_t, std::size_t>>& pairs,
                                      double width, const Context& context) {
    auto out = surface_between(source, pairs, width, [&] { context.check_cancelled(); });
    if (!out && !source.box().empty())
        context.warn(
            "no float grid of one transform shows in all frames where both sides match: all places "
            "are cut");
    return out;
}

/// What all loops have in common.
class Looping {
public:
    struct Params {
        OneOrTwo<int> lengths;  ///< that the loop may have: least and most
        Auto<int> fade;
        int loops = 1;
        Auto<int> start;
    };

    static void check(const Params& params, NodeCheck& check) {
        const auto [least, most] = params.lengths.of;
        if (least < 2 || most > most_frames)
            check.fault("frames", fmt::format("'frames' must be from 2 to {}", most_frames));
        if (least > most)
            check.fault("frames", fmt::format("'frames' must rise: [{}, {}]", most, least));
        if (params.fade && *params.fade >= least)
            check.fault("fade", fmt::format("a fade of {} frames leaves none of the {} frames of "
                                            "the loop as it is; lower it",
                                            *params.fade, least));
    }

    static NodeTraits traits(const Params& params) {
        return {.retimes = [&params](const std::vector<int>& frames) {
            const auto place = Place(params, frames);
            return even_frames(place.first, place.step,
                               static_cast<double>(params.lengths.of[1]) * params.loops);
        }};
    }

protected:
    /// How much two frames of the source differ, by their indices; 1: as neighbours do.
    using Difference = std::function<double(std::size_t, std::size_t)>;

    /// Finds the loop, reports it, and warns where its fade will be seen.
    /// @param numbers  of the frames of the source
    void close(const Params& params, const std::vector<int>& numbers, const Difference& difference,
               Context& context) {
        place_ = Place(params, numbers);
        loop_ = best_loop(request(params), numbers.size(), difference);
        const int from = numbers[loop_.first], to = numbers[loop_.first + loop_.length - 1];
        context.report("loop", {{"first", from},
                                {"last", to},
                                {"frames", loop_.length},
                                {"fade", loop_.fade},
                                {"difference", loop_.difference}});
        if (loop_.difference > much) context.warn(unlike(params, numbers.size(), difference));
        else if (loop_.first < loop_.fade)
            context.warn(fmt::format(
                "the loop's last {} frames fade into what comes before it, but there "
                "{} {} of the source: its first frame is held instead, so that what "
                "moves stops there; lower `frames` or `fade`, or give a longer sequence",
                loop_.fade, loop_.first == 1 ? "is" : "are",
                loop_.first == 0   ? std::string("no frames")
                : loop_.first == 1 ? "1 frame"
                                   : fmt::format("{} frames", loop_.first)));
    }

    const Loop& loop() const { return loop_; }
    /// Content of the context's frame.
    Loop::Shown shown(const Context& context) const {
        return loop_.shown(
            static_cast<std::size_t>((std::int64_t{context.frame()} - place_.first) / place_.step));
    }

private:
    static constexpr int most_frames = 100000;
    static constexpr double much = 4;  ///< difference of the ends from which on there is a warning

    /// Facts about a loop before its frames are read.
    struct Place {
        int first = 1, step = 1;

        Place() = default;
        /// @throws Failure if the sequence is shorter than the loop, or lacks frames
        Place(const Params& params, const std::vector<int>& frames)
            : first(params.start.value_or(frames.front())), step(step_of(frames)) {
            if (static_cast<std::size_t>(params.lengths.of[1]) > frames.size())
                throw Failure(fmt::format(
                    "a loop of {} frames needs as many of the source, which has {}; lower 'frames'",
                    params.lengths.of[1], frames.size()));
        }
    };

    static LoopRequest request(const Params& params) {
        const auto [least, most] = params.lengths.of;
        LoopRequest out{static_cast<std::size_t>(least), static_cast<std::size_t>(most),
                        std::nullopt};
        if (params.fade) out.fade = static_cast<std::size_t>(*params.fade);
        return out;
    }

    /// The warning about ends that differ much, with a length near the wanted one that closes
    /// better.
    std::string unlike(const Params& params, std::size_t frames,
                       const Difference& difference) const {
        const auto out = fmt::format(
            "the ends of the loop differ {:.2g} times as much as neighbouring frames, so that "
            "their fade will be seen",
            loop_.difference);
        const auto near = loop_.length / 4;
        auto wider = request(params);
        wider.least = std::max(loop_.fade + 1, loop_.length - near);
        wider.most = std::min(loop_.length + near, frames);
        const auto other = best_loop(wider, frames, difference);
        return other.length == loop_.length
                   ? out + "; a longer sequence leaves more choice"
                   : fmt::format("{}; with `frames: {}` it would be {:.2g}", out, other.length,
                                 other.difference);
    }

    Place place_;
    Loop loop_;
};

class LoopVolume : public Looping {
public:
    struct Ports {
        Ref<Volume> source;
        Optional<VectorGrid> velocity;
        Ref<Volume> volume;
    };

    void add(const Params&, const Ports& io, Context& context) {
        source_.add(*io.source, io.velocity, context.frame(), context.limits());
        thumbnails_.add(*io.source, io.velocity);
    }

    void finish(const Params& params, Ports&, Context& context) {
        close(
            params, source_.numbers(),
            [&](std::size_t a, std::size_t b) { return thumbnails_.difference(a, b); }, context);
        find_surface(context);
    }

    void run(const Params&, Ports& io, Context& context) const {
        const auto shows = shown(context);
        const auto a = source_.at(shows.at).volume;
        if (!shows.fade) {
            io.volume = std::make_shared<Volume>(a);
            return;
        }
        const auto b = source_.at(shows.before).volume;
        const auto share = [&](const openvdb::Vec3d& world) {
            return surface_ ? surface_->share(static_cast<int>(*shows.fade), world) : shows.share;
        };
        io.volume =
            std::make_shared<Volume>(volume_mixed(a, b, share, shows.nearer() == shows.at ? a : b));
    }

private:
    /// Finds where and when the end changes into the frames before the loop. Places that differ
    /// much take longer.
    void find_surface(Context& context) {
        std::vector<std::pair<std::size_t, std::size_t>> pairs;
        for (auto n = loop().length - loop().fade; n < loop().length; ++n)
            pairs.emplace_back(loop().first + n, loop().shown(n).before);
        constexpr double briefest = 3;
        const auto all = static_cast<double>(loop().fade);
        surface_ = surface_in(source_, pairs,
                              std::clamp(loop().difference, std::min(briefest, all), all), context);
    }

    Sequence source_;
    Thumbnails thumbnails_;
    std::optional<TimeSurface> surface_;  ///< nothing: all places change alike
};

class LoopPoints : public Looping {
public:
    struct Ports {
        Ref<Points> source;
        Ref<Points> points;
    };

    void add(const Params&, const Ports& io, Context& context) {
        source_.add(io.source, context.frame(), context.limits());
        Volume shown;
        shown.grids.push_back(in_grid(*io.source));
        thumbnails_.add(shown, nullptr);
    }

    void finish(const Params& params, Ports&, Context& context) {
        close(
            params, source_.numbers(),
            [&](std::size_t a, std::size_t b) { return thumbnails_.difference(a, b); }, context);
    }

    void run(const Params&, Ports& io, Context& context) const {
        const auto shows = shown(context);
        io.points = source_.at(shows.at);
        if (!shows.fade) return;
        const auto a = io.points, b = source_.at(shows.before);
        io.points = std::make_shared<Points>(points_mixed(
            *a, *b, [&](const openvdb::Vec3d&) { return shows.share; },
            shows.nearer() == shows.at ? *a : *b));
    }

private:
    NumberedFrames<Points> source_;
    Thumbnails thumbnails_;
};

class LoopMesh : public Looping {
public:
    struct Ports {
        Ref<Mesh> source;
        Ref<Mesh> mesh;
    };

    void add(const Params&, const Ports& io, Context& context) {
        if (last_) {
            if (!same_faces(*last_, *io.source))
                throw Failure(fmt::format(
                    "the faces of the mesh change between frame {} and {}, so that nothing says "
                    "where its vertices move to; loop the level set that the mesh is made of, and "
                    "make the mesh of that (sdf.to_mesh)",
                    source_.numbers().back(), context.frame()));
            typical_ += squared_distance(*last_, *io.source);
        }
        last_ = io.source;
        source_.add(io.source, context.frame(), context.limits());
    }

    void finish(const Params& params, Ports&, Context& context) {
        const double typical = typical_ / double(source_.size() - 1);
        close(
            params, source_.numbers(),
            [&](std::size_t a, std::size_t b) {
                context.check_cancelled();
                return typical == 0
                           ? 0
                           : std::sqrt(squared_distance(*source_.at(a), *source_.at(b)) / typical);
            },
            context);
        last_.reset();
    }

    void run(const Params&, Ports& io, Context& context) const {
        const auto shows = shown(context);
        io.mesh = source_.at(shows.at);
        if (shows.fade)
            io.mesh = std::make_shared<Mesh>(
                mesh_between(*io.mesh, *source_.at(shows.before), shows.share));
    }

private:
    NumberedFrames<Mesh> source_;
    Ref<Mesh> last_;
    double typical_ = 0;  ///< sum of the squared distances of neighbouring frames
};

template <class Node>
Declare<Node>& declare_loop(Declare<Node>& node) {
    return node
        .required("frames", &Looping::Params::lengths,
                  "Length of the loop, in frames. [20, 30] takes the length in this range that "
                  "closes best, writes 30 frames in any case, in which it goes round, and reports "
                  "the length.")
        .param("fade", &Looping::Params::fade, Unit::frames, between(1, 1e5),
               "Number of its last frames that fade. It is best if the source has so many frames "
               "more than the loop: else its first frame is held. auto is a quarter.")
        .param("loops", &Looping::Params::loops, Unit::none, between(1, 1000),
               "How often the loop is written, one behind the other, to look at it.")
        .param("start", &Looping::Params::start, Unit::frames,
               between(-farthest_frame, farthest_frame),
               "Number of the first frame. auto is that of the source.")
        .kept();
}

}  // namespace

NodeType time_loop() {
    return declare_loop(
               Declare<LoopVolume>("time.loop",
                                   "A loop of a chosen length: of all parts of the sequence the "
                                   "one that closes best. Its last frames go over into those "
                                   "before its first, each place when both match best there. For "
                                   "points it stands for time.loop_points, for a mesh for "
                                   "time.loop_mesh.")
                   .input("source", &LoopVolume::Ports::source,
                          "The grids, or one grid; points; a mesh.")
                   .input("velocity", &LoopVolume::Ports::velocity,
                          "Velocity, staggered or not. Where ends match is judged by where things "
                          "move to, too."))
        .kind<Points>("source", "time.loop_points")
        .kind<Mesh>("source", "time.loop_mesh")
        .output("volume", &LoopVolume::Ports::volume,
                "The same grids. Frames before the fade stay bit for bit. Points go over one "
                "by one, by their `id` if they have one. Whole numbers and masks are those of the "
                "nearer side.")
        .names_from("source")
        .version(5);
}

NodeType time_loop_points() {
    return declare_loop(
               Declare<LoopPoints>("time.loop_points",
                                   "A loop of particles: time.loop for points. Ends are compared "
                                   "by how many points lie where, and how they move.")
                   .input("source", &LoopPoints::Ports::source, "The particles."))
        .output("points", &LoopPoints::Ports::points,
                "The particles. Frames before the fade stay bit for bit. Then they go over one by "
                "one, by their `id` if they have one, so that none is shown twice.");
}

NodeType time_loop_mesh() {
    return declare_loop(
               Declare<LoopMesh>("time.loop_mesh",
                                 "A loop of a mesh whose faces stay the same: time.loop for "
                                 "meshes. Ends are compared by where their vertices lie.")
                   .input("source", &LoopMesh::Ports::source, "The mesh."))
        .output("mesh", &LoopMesh::Ports::mesh,
                "The mesh. Frames before the fade stay bit for bit. Then vertices and attributes "
                "of floats go over on straight ways.");
}

}  // namespace fluidcarve
