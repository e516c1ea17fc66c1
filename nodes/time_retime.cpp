#include "nodes/time.h"
#include "carve/time/between.h"
#include "carve/time/pace.h"
#include "carve/time/sequence.h"
#include "carve/time/thumbnails.h"
#include "carve/time/time_surface.h"
#include "graph/types/node_type.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

namespace fluidcarve {

namespace {

class Retime {
public:
    struct Params : PaceWish {
        Auto<double> scale;
        Transport transport = Transport::semi_lagrangian;
    };
    struct Ports {
        Ref<Volume> source;
        Optional<VectorGrid> velocity;
        Ref<Volume> volume;
    };

    static void check(const Params& params, NodeCheck& check) {
        const int stated = int(params.speed.has_value()) + int(params.count.has_value()) +
                           int(!params.curve.empty());
        if (stated == 0) check.fault("type", "needs a 'speed', a number of 'frames', or a 'curve'");
        if (stated > 1)
            check.fault("type", "takes one of 'speed', 'frames' and 'curve', not several");
        if (params.speed && *params.speed == 0)
            check.fault(
                "speed",
                "'speed' must not be 0; to hold a frame, state a curve such as [[1, 7], [24, 7]]");
        if (params.start && !params.curve.empty())
            check.fault("start", "a curve says itself which frame is the first; leave 'start' out");
        for (std::size_t n = 0; n < params.curve.size(); ++n)
            if (params.curve[n].size() != 2)
                return check.fault("curve", "a point of 'curve' is [frame, frame of the source]");
            else if (n > 0 && params.curve[n][0] <= params.curve[n - 1][0])
                return check.fault(
                    "curve", fmt::format("the frames of 'curve' must rise, but {:g} follows {:g}",
                                         params.curve[n][0], params.curve[n - 1][0]));
        if (check.connections("velocity") == 0)
            check.warn("velocity",
                       "without a 'velocity', frames between those of the source are found by what "
                       "is seen alone: connect it if there is one");
    }
    static std::vector<int> retimes(const Params& params, const std::vector<int>& frames) {
        return Pace(params, frames).frames();
    }

    void add(const Params&, const Ports& io, Context& context) {
        source_.add(*io.source, io.velocity, context.frame(), context.limits());
    }

    void finish(const Params& params, Ports&, Context& context) {
        pace_.emplace(params, source_.numbers());
        if (!source_.has_velocity() || source_.size() < 2) return;
        scale_ = params.scale ? *params.scale : found_scale(context);
        context.report("retime", {{"scale", scale_}});
    }

    void run(const Params& params, Ports& io, Context& context) const {
        const auto moment = pace_->moment(context.frame());
        const auto a = source_.at(moment.place);
        auto out = std::make_shared<Volume>(a.volume);
        if (moment.share > 0) {
            const auto b = source_.at(moment.place + 1);
            const auto shown = moving_in(a, b);
            VectorGrid::Ptr motion;
            if (shown)
                motion =
                    motion_between(shown->first, shown->second,
                                   scale_ * frames_behind(moment.place), context.memory_budget());
            else
                context.warn(
                    "no float grid shows where things move to: frames between those of the source "
                    "are blended");
            *out = volume_between(a.volume, b.volume, moment.share, motion.get(), params.transport);
        }
        if (a.velocity) *out = scaled(*out, a.velocity->getName(), moment.rate);
        io.volume = out;
    }

private:
    /// The scale at which a few pairs of frames fit best, moved to the moment halfway. World units
    /// per frame, of a velocity of 1.
    double found_scale(Context& context) const {
        struct Pair {
            MovingFrame a, b;
            int frames;  ///< from one to the other
        };
        std::vector<Pair> pairs;
        double speed = 0;
        constexpr std::size_t most_pairs = 3;
        const auto gaps = source_.size() - 1, count = std::min(most_pairs, gaps);
        for (std::size_t n = 0; n < count; ++n) {
            const auto place = (2 * n + 1) * gaps / (2 * count);
            if (const auto shown = moving_in(source_.at(place), source_.at(place + 1))) {
                pairs.push_back({shown->first, shown->second, frames_behind(place)});
                speed = std::max(speed,
                                 typical_speed(shown->first) / shown->first.shown->voxelSize().x());
            }
        }
        if (pairs.empty() || speed == 0) return 0;
        const auto error = [&](double voxels) {
            context.check_cancelled();
            double out = 0;
            for (const auto& [a, b, frames] : pairs)
                out += mismatch(a, b, frames * voxels / speed, context.memory_budget());
            return out;
        };
        // By the typical motion in voxels: first roughly, then by golden section.
        double best = 0, least = error(0);
        constexpr double finest = 0.05, farthest = 8, step = 1.5;
        for (double voxels = finest; voxels < farthest; voxels *= step)
            if (const double here = error(voxels); here < least) {
                least = here;
                best = voxels;
            }
        if (best == 0) return 0;
        const double golden = (std::sqrt(5.0) - 1) / 2;
        double low = best / step, high = best * step;
        double x = high - golden * (high - low), y = low + golden * (high - low), at_x = error(x),
               at_y = error(y);
        while (high - low > 0.02 * best) {
            const bool lower = at_x < at_y;
            (lower ? high : low) = lower ? y : x;
            (lower ? y : x) = lower ? x : y;
            (lower ? at_y : at_x) = lower ? at_x : at_y;
            auto& fresh = lower ? x : y;
            fresh = lower ? high - golden * (high - low) : low + golden * (high - low);
            (lower ? at_x : at_y) = error(fresh);
        }
        return (low + high) / 2 / speed;
    }

    /// From a frame of the source to the next.
    int frames_behind(std::size_t place) const {
        return source_.numbers()[place + 1] - source_.numbers()[place];
    }

    Sequence source_;
    std::optional<Pace> pace_;
    double scale_ = 0;
};

}  // namespace

NodeType time_retime() {
    using Params = Retime::Params;
    return Declare<Retime>("time.retime",
                           "The same sequence, faster, slower, backwards, held, or along a curve. "
                           "Frames between those of the source are moved there from both of their "
                           "neighbours. What follows this node has the new frames.")
        .input("source", &Retime::Ports::source, "The grids, or one grid.")
        .input("velocity", &Retime::Ports::velocity,
               "Velocity, staggered or not. It says where things move, and is itself scaled by the "
               "speed. Left out, motion is found by what is seen alone.")
        .param("speed", &PaceWish::speed, Unit::none, between(-1000, 1000),
               "Frames of the source per frame: 0.5 is half as fast and twice as long; -1 runs "
               "backwards.")
        .param("frames", &PaceWish::count, Unit::frames, between(1, 1e6),
               "Number of frames that show the whole source, instead of `speed`.")
        .param("curve", &PaceWish::curve,
               "Points [frame, frame of the source], instead of `speed`: [[1001, 1001], [1012, "
               "1024], [1036, 1024]] runs twice as fast, then holds. Linear between.")
        .param("start", &PaceWish::start, Unit::frames, any_number(),
               "Number of the first frame. auto is that of the source.")
        .param(
            "scale", &Params::scale, Unit::none, any_number(),
            "How far a velocity of 1 moves from one frame to the next, world units: 1/24 for world "
            "units per second at 24 frames. auto finds it in the sequence; the report tells it.")
        .param("transport", &Params::transport,
               "How values are moved. mac_cormack is sharper, and takes twice as long.")
        .output(
            "volume", &Retime::Ports::volume,
            "The same grids. Frames of the source stay bit for bit, but for a velocity whose time "
            "goes faster or slower. Sums of floats between frames lie between theirs; level sets "
            "are distances; whole numbers, masks and points are those of the nearer frame.")
        .names_as("volume", "source")
        .kept();
}

}  // namespace fluidcarve
