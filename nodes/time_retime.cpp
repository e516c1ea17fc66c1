#include "nodes/time.h"

#include "carve/base/median.h"
#include "carve/points/point_vectors.h"
#include "carve/stream/mesh_stream.h"
#include "carve/stream/points_stream.h"
#include "carve/time/between.h"
#include "carve/time/frame_list.h"
#include "carve/time/mesh_between.h"
#include "carve/time/motions.h"
#include "carve/time/pace.h"
#include "carve/time/paced.h"
#include "carve/time/points_between.h"
#include "carve/time/scale_search.h"
#include "carve/time/sequence.h"
#include "graph/types/node_type.h"
#include "nodes/params/pace_params.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace fluidcarve {

namespace {

/// Difference between the numbers of a frame and the next.
double frames_behind(const std::vector<int>& numbers, std::size_t place) {
    return static_cast<double>(numbers[place + 1]) - numbers[place];
}

/// At most three places of pairs of neighbouring frames, spread evenly.
/// @param frames  number of frames, at least 2
std::vector<std::size_t> few_places(std::size_t frames) {
    constexpr std::size_t most = 3;
    const auto gaps = frames - 1, count = std::min(most, gaps);
    std::vector<std::size_t> out;
    for (std::size_t n = 0; n < count; ++n) out.push_back((2 * n + 1) * gaps / (2 * count));
    return out;
}

constexpr auto scale_doc =
    "How far a velocity of 1 moves from one frame to the next, world units: 1/24 for world units "
    "per second at 24 frames. auto finds it in the sequence; the report tells it.";

/// The base of all nodes that retime.
struct Paced {
    static void check(const PaceParams& params, NodeCheck& check) { check_pace(params, check); }
    static NodeTraits traits(const PaceParams& params) {
        return {.retimes = [&params](const std::vector<int>& frames) {
            return pace_of(params, frames).frames();
        }};
    }
};

class Retime : public Paced {
public:
    struct Params : PaceParams {
        Auto<double> scale;
        Transport transport = Transport::semi_lagrangian;
    };
    struct Ports {
        Ref<Volume> source;
        Optional<VectorGrid> velocity;
        Ref<Volume> volume;
    };

    void add(const Params&, const Ports& io, Context& context) {
        source_.add(*io.source, io.velocity, context.frame(), context.limits());
    }

    void finish(const Params& params, Ports&, Context& context) {
        pace_ = pace_of(params, source_.numbers());
        double scale = 0;
        if (!source_.has_velocity()) {
            for (const auto& grid : source_.at(0).volume.grids)
                if (grid.header().isType<VectorGrid>())
                    context.warn(fmt::format(
                        "'velocity' is not connected, so that motion is found by what is seen "
                        "alone; connect '{}' if it is the velocity",
                        grid.name()));
        } else if (source_.size() > 1) {
            scale = params.scale ? *params.scale : found_scale(context);
            context.report("retime", {{"scale", scale}});
        }
        motions_.emplace(source_, scale, context.limits().memory);
    }

    void run(const Params& params, Ports& io, Context& context) const {
        const auto moment = pace_->moment(context.frame());
        const auto a = source_.at(moment.place);
        auto out = std::make_shared<Volume>(a.volume);
        if (moment.share > 0) {
            const auto motion = motions_->from(moment.place);
            if (!motion && std::ranges::any_of(a.volume.grids, [](const VolumeGrid& grid) {
                    return grid.header().isType<FloatGrid>();
                }))
                context.warn(
                    "no float grid shows where things move to: frames between those of the source "
                    "are blended");
            *out = volume_between(a.volume, source_.at(moment.place + 1).volume, moment.share,
                                  motion.get(), params.transport);
        }
        *out = velocities_scaled(*out, a.velocity ? a.velocity->getName() : "", moment.rate);
        io.volume = out;
    }

private:
    /// The scale at which a few pairs of frames match best, each moved to the moment halfway.
    /// World units per frame at a velocity of 1.
    double found_scale(Context& context) const {
        struct Pair {
            MovingFrame a, b;
            double frames;  ///< from one frame to the other
        };
        std::vector<Pair> pairs;
        double speed = 0;
        for (const auto place : few_places(source_.size())) {
            if (const auto shown = moving_in(source_.at(place), source_.at(place + 1))) {
                pairs.push_back(
                    {shown->first, shown->second, frames_behind(source_.numbers(), place)});
                speed = std::max(speed,
                                 typical_speed(shown->first) / shown->first.shown->voxelSize().x());
            }
        }
        if (pairs.empty() || speed == 0) return 0;
        return least_error_at([&](double voxels) {
                   context.check_cancelled();
                   double out = 0;
                   for (const auto& [a, b, frames] : pairs)
                       out += mismatch(a, b, frames * voxels / speed, context.limits().memory);
                   return out;
               }) /
               speed;
    }

    Sequence source_;
    std::optional<Pace> pace_;
    std::optional<Motions> motions_;
};

}  // namespace

NodeType time_retime() {
    using Params = Retime::Params;
    return declare_pace(Declare<Retime>(
                            "time.retime",
                            "The same sequence, faster, slower, backwards, held, or along a curve. "
                            "Frames between those of the source are moved there from both of their "
                            "neighbours. What follows this node has the new frames. For points it "
                            "stands for time.retime_points, for a mesh for time.retime_mesh.")
                            .input("source", &Retime::Ports::source,
                                   "The grids, or one grid; points; a mesh.")
                            .input("velocity", &Retime::Ports::velocity,
                                   "Velocity, staggered or not. It says where things move, and is "
                                   "itself scaled by the speed. Left out, motion is found by what "
                                   "is seen alone."))
        .param("scale", &Params::scale, Unit::none, any_number(), scale_doc)
        .param("transport", &Params::transport,
               "How values are moved. mac_cormack is sharper, and takes twice as long.")
        .output(
            "volume", &Retime::Ports::volume,
            "The same grids. Frames of the source stay bit for bit, but for a velocity whose time "
            "goes faster or slower. Sums of floats between frames lie between theirs; level sets "
            "are means of distances; points go as in time.retime_points; whole numbers and masks "
            "are those of the nearer frame.")
        .kind<Points>("source", "time.retime_points")
        .kind<Mesh>("source", "time.retime_mesh")
        .names_from("source")
        .version(4)
        .kept();
}

namespace {

class RetimePoints : public Paced {
public:
    struct Params : PaceParams {
        Auto<double> scale;
    };
    struct Ports {
        Ref<Points> source;
        Ref<Points> points;
    };

    void add(const Params&, const Ports& io, Context& context) {
        source_.add(io.source, context.frame(), context.limits());
    }

    void finish(const Params& params, Ports&, Context& context) {
        pace_ = pace_of(params, source_.numbers());
        // Particles may be born later than the first frame.
        auto some = source_.at(0);
        for (std::size_t n = 1; some->size() == 0 && n < source_.size(); ++n) some = source_.at(n);
        motion_.velocity = velocity_name(*some);
        if (motion_.velocity.empty()) {
            if (some->size() > 0 && !some->has_ids())
                context.warn(
                    "the points have neither a whole number `id` nor a velocity, so that "
                    "nothing says where they move to: between frames of the source they "
                    "stand still");
            return;
        }
        motion_.scale = params.scale ? *params.scale : found_scale(context);
        context.report("retime", {{"velocity", motion_.velocity}, {"scale", motion_.scale}});
    }

    void run(const Params&, Ports& io, Context& context) const {
        const auto moment = pace_->moment(context.frame());
        io.points = source_.at(moment.place);
        if (moment.share > 0) {
            auto motion = motion_;
            motion.scale *= frames_behind(source_.numbers(), moment.place);
            io.points = std::make_shared<Points>(
                points_between(*io.points, *source_.at(moment.place + 1), moment.share, motion));
        }
        if (motion_.velocity.empty() || moment.rate == 1) return;
        io.points = std::make_shared<Points>(
            paced(*io.points, [&](const openvdb::Vec3d&) { return moment.rate; }));
    }

private:
    /// The median of the scales of a few pairs of frames.
    double found_scale(Context& context) const {
        std::vector<double> found;
        for (const auto place : few_places(source_.size())) {
            context.check_cancelled();
            const double scale =
                point_scale(*source_.at(place), *source_.at(place + 1), motion_.velocity);
            // Frames without points or motion give no scale.
            if (scale != 0) found.push_back(scale / frames_behind(source_.numbers(), place));
        }
        return found.empty() ? 0 : median_of(std::move(found));
    }

    NumberedFrames<Points> source_;
    std::optional<Pace> pace_;
    PointMotion motion_;
};

class RetimeMesh : public Paced {
public:
    struct Params : PaceParams {};
    struct Ports {
        Ref<Mesh> source;
        Ref<Mesh> mesh;
    };

    void add(const Params&, const Ports& io, Context& context) {
        source_.add(io.source, context.frame(), context.limits());
    }
    void finish(const Params& params, Ports&, Context&) {
        pace_ = pace_of(params, source_.numbers());
    }

    void run(const Params&, Ports& io, Context& context) const {
        const auto moment = pace_->moment(context.frame());
        io.mesh = source_.at(moment.place);
        if (moment.share == 0) return;
        const auto next = source_.at(moment.place + 1);
        if (same_faces(*io.mesh, *next)) {
            io.mesh = std::make_shared<Mesh>(mesh_between(*io.mesh, *next, moment.share));
            return;
        }
        context.warn(
            "the faces of the mesh change, so that nothing says where its vertices move "
            "to: between frames of the source it is that of the nearer one");
        if (moment.share >= 0.5) io.mesh = next;
    }

private:
    NumberedFrames<Mesh> source_;
    std::optional<Pace> pace_;
};

}  // namespace

NodeType time_retime_points() {
    using Params = RetimePoints::Params;
    return declare_pace(
               Declare<RetimePoints>(
                   "time.retime_points",
                   "The same particles at another pace: time.retime for points. What follows this "
                   "node has the new frames.")
                   .input("source", &RetimePoints::Ports::source, "The particles."))
        .param("scale", &Params::scale, Unit::none, any_number(), scale_doc)
        .output("points", &RetimePoints::Ports::points,
                "The particles, with all attributes. Frames of the source stay bit for bit, but "
                "for a velocity whose time goes faster or slower. Between them, particles with a "
                "whole number `id` go from place to place along their velocities; those that "
                "only one frame has appear or vanish one by one. Without ids, the particles are "
                "those of the nearer frame, moved along their velocities.")
        .kept();
}

NodeType time_retime_mesh() {
    return declare_pace(
               Declare<RetimeMesh>("time.retime_mesh",
                                   "The same mesh at another pace: time.retime for meshes. What "
                                   "follows this node has the new frames.")
                   .input("source", &RetimeMesh::Ports::source, "The mesh."))
        .output("mesh", &RetimeMesh::Ports::mesh,
                "The mesh. Frames of the source stay bit for bit. Between them, vertices and "
                "attributes of floats move straight from frame to frame if the faces are the "
                "same; else the mesh is that of the nearer frame.")
        .version(2)
        .kept();
}

}  // namespace fluidcarve
