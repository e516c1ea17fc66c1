#include "nodes/rig/advect.h"

#include "graph/text/problem.h"
#include "nodes/rig/rig.h"

#include <fmt/format.h>
#include <openvdb/tools/Interpolation.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {

constexpr double fewest_steps_per_call = 1e-4;  // smallest step, as a share of the duration: a very high velocity must not take forever

/// A velocity field in which points move.
class Flow {
public:
    explicit Flow(const VectorGrid& velocity)
        : grid_(velocity), accessor_(velocity.getConstAccessor()), staggered_(velocity.getGridClass() == openvdb::GRID_STAGGERED) {}

    Vec3d at(const Vec3d& world) const {
        const auto index = grid_.worldToIndex(world);
        openvdb::Vec3s out;
        if (staggered_) openvdb::tools::StaggeredBoxSampler::sample(accessor_, index, out);
        else openvdb::tools::BoxSampler::sample(accessor_, index, out);
        if (!openvdb::math::isFinite(out)) throw Failure(fmt::format("grid '{}' has a value that is not finite near {}", grid_.getName(), text_of(world)));
        return Vec3d(out);
    }

    /// Moves a point for `duration`.
    /// @param voxel  longest way of a step, world units
    /// @return nothing if the point starts or comes where the velocity is inactive
    std::optional<Vec3d> moved(Vec3d p, double duration, double voxel) const {
        for (double left = duration; left > 0;) {
            if (!accessor_.isValueOn(grid_.transform().worldToIndexCellCentered(p))) return std::nullopt;
            const auto a = at(p);
            const double speed = a.length();
            if (speed == 0) return p;
            const double step = std::min(left, std::max(voxel / speed, fewest_steps_per_call * duration));
            const auto b = at(p + 0.5 * step * a), c = at(p + 0.5 * step * b), d = at(p + step * c);
            p += step / 6 * (a + 2.0 * b + 2.0 * c + d);
            left = step < left ? left - step : 0;
        }
        return accessor_.isValueOn(grid_.transform().worldToIndexCellCentered(p)) ? std::optional(p) : std::nullopt;
    }

private:
    const VectorGrid& grid_;
    VectorGrid::ConstAccessor accessor_;
    bool staggered_;
};

double voxel_edge(const VectorGrid& grid) {
    const auto size = grid.voxelSize();
    return std::min({size.x(), size.y(), size.z()});
}

class RigAdvect {
public:
    struct Params {
        Vec3 seed{};
        double radius = 0;
        int count = 64;
        double scale = 1;
        Auto<double> apart;
        Vec3 up{0, 0, 1};
    };
    struct Ports {
        Ref<VectorGrid> velocity;
        Ref<Rig> rig;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (Vec3d(params.up.data()).length() == 0) check.fault("up", "'up' has no direction");
        if (!(params.scale > 0)) check.fault("scale", "'scale' must be more than 0");
    }

    void add(const Params& params, const Ports& io, Context& context) {
        context.check_cancelled();
        sets_.push_back(points_in_ball(seed_of(params), params.radius, params.count));
        for (auto& set : sets_) advect(set, *io.velocity, params.scale * frames_until_next(context));
        apart_ = params.apart.value_or(voxel_edge(*io.velocity));
    }

    void finish(const Params& params, Ports& io, Context&) {
        Rig rig;
        rig.up = Vec3d(params.up.data());
        rig.points = {seed_of(params)};
        // The latest set is nearest to the seed.
        for (auto set = sets_.rbegin(); set != sets_.rend(); ++set) {
            if (set->empty()) continue;
            const auto middle = std::accumulate(set->begin(), set->end(), Vec3d(0)) / static_cast<double>(set->size());
            if ((middle - rig.points.back()).length() >= std::max(apart_, 1e-12)) rig.points.push_back(middle);
        }
        if (std::all_of(sets_.begin(), sets_.end(), [](const auto& set) { return set.empty(); }))
            throw Failure(fmt::format("no point around the seed, {}, stays where the velocity is active: move 'seed' into the flow, or take a smaller 'scale'",
                                      text_of(seed_of(params))));
        if (rig.points.size() < 2)
            throw Failure(
                fmt::format("the points stay within {:g} of the seed, {}: the velocity there is too small, or 'scale' is", apart_, text_of(seed_of(params))));
        if (const auto fault = rig_fault(rig); !fault.empty()) throw Failure(fault + "; state a larger 'apart' or 'radius'");
        io.rig = std::make_shared<Rig>(std::move(rig));
    }

private:
    static Vec3d seed_of(const Params& params) { return Vec3d(params.seed.data()); }

    static double frames_until_next(const Context& context) {
        const auto& frames = context.frames();
        const auto t = context.place();
        if (frames.size() < 2) return 1;
        return t + 1 < frames.size() ? frames[t + 1] - frames[t] : frames[t] - frames[t - 1];
    }

    std::vector<std::vector<Vec3d>> sets_;  ///< points that each frame added and that are still in the flow, `[frame][point]`
    double apart_ = 0;
};

}  // namespace

std::vector<Vec3d> points_in_ball(const Vec3d& center, double radius, int count) {
    // A sequence that fills the cube evenly: multiples of powers of 1 / root, where root^4 = root + 1.
    constexpr double root = 1.2207440846057596;
    std::vector<Vec3d> out;
    Vec3d sum(0);
    for (int n = 1; out.size() < static_cast<std::size_t>(count); ++n) {
        const auto part = [n](double by) { return 2 * (n * by - std::floor(n * by)) - 1; };
        const Vec3d in_cube(part(1 / root), part(1 / (root * root)), part(1 / (root * root * root)));
        if (in_cube.length() > 1) continue;
        out.push_back(radius * in_cube);
        sum += out.back();
    }
    for (auto& point : out) point += center - sum / static_cast<double>(count);
    return out;
}

void advect(std::vector<Vec3d>& points, const VectorGrid& velocity, double duration) {
    const double voxel = voxel_edge(velocity);
    std::vector<std::optional<Vec3d>> moved(points.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 16), [&](const tbb::blocked_range<std::size_t>& range) {
        const Flow flow(velocity);
        for (auto n = range.begin(); n < range.end(); ++n) moved[n] = flow.moved(points[n], duration, voxel);
    });
    points.clear();
    for (const auto& point : moved)
        if (point) points.push_back(*point);
}

NodeType rig_advect() {
    using Params = RigAdvect::Params;
    return Declare<RigAdvect>("rig.advect",
                              "A rig that follows the flow. Each frame adds points around a seed, and the flow moves all points on. At the end, the rig runs "
                              "from the seed through the centroid of each frame's points. Points that left the flow do not count.")
        .input("velocity", &RigAdvect::Ports::velocity, "Velocity, staggered or not.")
        .required("seed", &Params::seed, Unit::world, any_number(), "Where the flow comes from.")
        .required("radius", &Params::radius, Unit::world, at_least(0), "Radius of the ball of points around the seed.")
        .param("count", &Params::count, Unit::none, between(1, 1e5), "Number of points that each frame adds.")
        .param("scale", &Params::scale, Unit::none, any_number(),
               "World units that a velocity of 1 moves a point from one frame to the next: 1/24 for units per second at 24 frames. Blender's velocities are "
               "roughly tenths of a voxel per frame: use a tenth of the voxel size. A larger value makes the rig longer if there are few frames.")
        .param("apart", &Params::apart, Unit::world, at_least(0),
               "Smallest distance between neighbouring points of the rig: centroids nearer to the one before are left out. auto is a voxel.")
        .param("up", &Params::up, Unit::none, any_number(), "Direction of the lattice's `v` at the start of the rig; made orthogonal to the path.")
        .output("rig", &RigAdvect::Ports::rig,
                "The rig, one for all frames: the seed, then the centroids as they are in the last frame, those of the latest points first.")
        .kept();
}

}  // namespace fluidcarve
