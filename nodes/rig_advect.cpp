#include "carve/base/failure.h"
#include "carve/rig/advect.h"
#include "carve/rig/rig.h"
#include "carve/rig/streaklines.h"
#include "carve/volume/cubes.h"
#include "carve/volume/volume.h"
#include "graph/types/node_type.h"
#include "nodes/params/check_params.h"
#include "nodes/rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>
#include <vector>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {

enum class ScaleUnit { world, voxel };

}  // namespace

template <>
struct ChoiceNames<ScaleUnit> {
    static constexpr std::array names = {std::pair{"world", ScaleUnit::world},
                                         std::pair{"voxel", ScaleUnit::voxel}};
};

namespace {

/// The points added in one frame that are still in the flow.
struct PointSet {
    std::size_t number = 0;  ///< index of the frame
    std::vector<Vec3d> points;

    Vec3d middle() const {
        return std::accumulate(points.begin(), points.end(), Vec3d(0)) /
               static_cast<double>(points.size());
    }
};

class RigAdvect {
public:
    struct Params {
        Vec3 seed{};
        double radius = 0;
        int count = 64;
        double scale = 1;
        ScaleUnit scale_unit = ScaleUnit::world;
        Auto<double> apart;
        Vec3 up{0, 0, 1};
        bool animate = false;
        Auto<double> length;
        int steady = 4;
    };
    struct Ports {
        Ref<VectorGrid> velocity;
        Ref<Rig> rig;
    };

    static NodeTraits traits(const Params& params) { return {.animates = params.animate}; }

    static void check(const Params& params, NodeCheck& check) {
        check_direction("up", params.up, check);
        if (!(params.scale > 0)) check.fault("scale", "'scale' must be more than 0");
        if (params.length && !(*params.length > 0))
            check.fault("length", "'length' must be more than 0");
        if (params.animate && params.apart && !(*params.apart > 0))
            check.fault("apart", "'apart' must be more than 0 where the rig moves");
        for (const auto* const name : {"length", "steady"})
            if (!params.animate && check.stated(name))
                check.fault(
                    name,
                    fmt::format(
                        "one rig for all frames has no '{}'; set `animate: true`, or leave it out",
                        name));
    }

    void add(const Params& params, const Ports& io, Context& context) {
        context.check_cancelled();
        const double voxel = shortest_edge(io.velocity->transform());
        apart_ = params.apart.value_or(voxel);
        sets_.push_back(
            {context.t(), points_in_ball(seed_of(params), params.radius, params.count)});
        if (params.animate) {
            streaklines_.push_back(streakline());
            forget(params.length);
        }
        const double duration = params.scale * (params.scale_unit == ScaleUnit::voxel ? voxel : 1) *
                                frames_until_next(context);
        for (auto& set : sets_) advect(set.points, *io.velocity, duration);
        // If few points of a set are left, their centroid lies aside.
        std::erase_if(sets_, [&](const PointSet& set) {
            return params.animate ? 2 * set.points.size() < all_of(params) : set.points.empty();
        });
    }

    void finish(const Params& params, Ports& io, Context& context) {
        if (params.animate) return animate(params, context);
        Rig rig{{seed_of(params)}, false, Vec3d(params.up.data()), {}};
        // The latest set is nearest to the seed.
        for (auto set = sets_.rbegin(); set != sets_.rend(); ++set)
            if (const auto middle = set->middle();
                (middle - rig.points.back()).length() >= std::max(apart_, 1e-12))
                rig.points.push_back(middle);
        if (sets_.empty()) refuse_lost(params);
        if (rig.points.size() < 2) refuse_still(params);
        if (const auto fault = rig_fault(rig); !fault.empty())
            throw Failure(fault + "; state a larger 'apart' or 'radius'");
        io.rig = std::make_shared<Rig>(std::move(rig));
    }

    void run(const Params& params, Ports& io, Context& context) const {
        if (params.animate) io.rig = rigs_.at(context.t());
    }

private:
    static Vec3d seed_of(const Params& params) { return Vec3d(params.seed.data()); }
    static std::size_t all_of(const Params& params) {
        return static_cast<std::size_t>(params.count);
    }

    static double frames_until_next(const Context& context) {
        const auto& frames = context.frames();
        const auto t = context.t();
        if (frames.size() < 2) return 1;
        const auto from = t + 1 < frames.size() ? t : t - 1;
        return static_cast<double>(frames[from + 1]) - frames[from];
    }

    [[noreturn]] static void refuse_lost(const Params& params) {
        throw Failure(
            fmt::format("no point around the seed, {}, stays where the velocity is active: move "
                        "'seed' into the flow, or take a smaller 'scale'",
                        to_text(seed_of(params))));
    }
    [[noreturn]] void refuse_still(const Params& params) const {
        throw Failure(
            fmt::format("the points stay within {:g} of the seed, {}: the velocity there is too "
                        "small, or 'scale' is",
                        apart_, to_text(seed_of(params))));
    }

    /// The sets as they are now. The latest is nearest to the seed.
    Streakline streakline() const {
        Streakline out;
        for (auto set = sets_.rbegin(); set != sets_.rend(); ++set)
            out.points.push_back(set->middle());
        if (!sets_.empty()) out.oldest = sets_.front().number;
        return out;
    }

    /// Drops the sets beyond the end of the rig, whose points need not be moved any more.
    void forget(const Auto<double>& length) {
        if (!length) return;
        const auto& points = streaklines_.back().points;
        double along = 0;
        std::size_t within = 1;
        for (; within < points.size() && along <= *length; ++within)
            along += (points[within] - points[within - 1]).length();
        sets_.erase(sets_.begin(), sets_.end() - static_cast<std::ptrdiff_t>(within));
    }

    void animate(const Params& params, const Context& context) {
        streaklines_.push_back(streakline());
        const auto lines = moving_lines(streaklines_, {apart_, params.length, params.steady});
        if (lines.empty()) {
            if (std::ranges::all_of(streaklines_,
                                    [](const Streakline& line) { return line.points.size() < 2; }))
                refuse_lost(params);
            refuse_still(params);
        }
        for (std::size_t t = 0; t < lines.size(); ++t) {
            rigs_.push_back(
                std::make_shared<Rig>(Rig{lines[t], false, Vec3d(params.up.data()), {}}));
            if (const auto fault = rig_fault(*rigs_.back()); !fault.empty())
                throw Failure(
                    fmt::format("frame {}: {}; state a larger 'apart', 'radius' or 'steady'",
                                context.frames()[t], fault));
        }
        warn_of_moves(params, lines, context);
    }

    /// Warns of the rig that is furthest from that of the frame before, if they differ by more than
    /// a step along the rig.
    void warn_of_moves(const Params& params, const std::vector<std::vector<Vec3d>>& lines,
                       const Context& context) const {
        double furthest = 0;
        std::size_t at = 0;
        for (std::size_t t = 1; t < lines.size(); ++t)
            if (const double by = largest_distance(lines[t - 1], lines[t]); by > furthest) {
                furthest = by;
                at = t;
            }
        if (furthest <= apart_ * (1 + 1e-9)) return;
        context.warn(fmt::format(
            "the rig moves by up to {:.3g} from frame {} to frame {}, more than the {:.3g} between "
            "its points, and seams would jump with it: state a larger 'steady' than {}",
            furthest, context.frames()[at - 1], context.frames()[at], apart_, params.steady));
    }

    std::vector<PointSet> sets_;  ///< sets with points, the oldest first
    double apart_ = 0;
    std::vector<Streakline> streaklines_;  ///< of each frame, if the rig moves
    std::vector<Ref<Rig>> rigs_;           ///< of each frame, if the rig moves
};

}  // namespace

NodeType rig_advect() {
    using Params = RigAdvect::Params;
    return Declare<RigAdvect>(
               "rig.advect",
               "A rig that follows the flow. Each frame adds points around a seed, and the flow "
               "moves all points on. The rig runs from the seed through the centroid of each "
               "frame's points. Points that left the flow do not count.")
        .input("velocity", &RigAdvect::Ports::velocity, "Velocity, staggered or not.")
        .required("seed", &Params::seed, Unit::world, any_number(), "Where the flow comes from.")
        .required("radius", &Params::radius, Unit::world, at_least(0),
                  "Radius of the ball of points around the seed.")
        .param("count", &Params::count, Unit::none, between(1, 1e5),
               "Number of points that each frame adds.")
        .param("scale", &Params::scale, Unit::none, any_number(),
               "How far a velocity of 1 moves a point from one frame to the next, in `scale_unit`: "
               "1/24 for world units per second at 24 frames. Blender's velocities are roughly "
               "tenths of a voxel per frame: use 0.1 and `scale_unit: voxel`. A larger value makes "
               "the rig longer if there are few frames.")
        .param("scale_unit", &Params::scale_unit,
               "What `scale` counts: world units, or voxels of the velocity.")
        .param("apart", &Params::apart, Unit::world, at_least(0),
               "Smallest distance between neighbouring points of the rig: centroids nearer to the "
               "one before are left out. A moving rig is then drawn anew in steps of about this "
               "length. auto is a voxel.")
        .param(
            "up", &Params::up, Unit::none, any_number(),
            "Direction of the lattice's `v` at the start of the rig; made orthogonal to the path.")
        .param("animate", &Params::animate,
               "A rig of its own for each frame, through the centroids as they are in that frame. "
               "Where no points have come yet, it runs along the way that the first ones take "
               "later. All rigs have the same length and number of points.")
        .param("length", &Params::length, Unit::world, at_least(0),
               "Length of a moving rig: it is cut there, or goes on straight, in the direction "
               "from its start to its end. auto: as long as the longest is.")
        .param("steady", &Params::steady, Unit::none, between(0, 1000),
               "Frames before and after a frame that have a share in its rig, the nearer the more. "
               "0 follows the flow as it is. A warning says if the rig still moves by more than "
               "`apart` from a frame to the next.")
        .output("rig", &RigAdvect::Ports::rig,
                "The rig: the seed, then the centroids, those of the latest points first. One for "
                "all frames, with the centroids as they are in the last frame; with `animate`, one "
                "per frame.")
        .kept();
}

}  // namespace fluidcarve
