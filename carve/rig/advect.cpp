#include "carve/rig/advect.h"

#include "carve/base/failure.h"
#include "carve/field/extent.h"
#include "carve/rig/rig.h"
#include "carve/volume/cubes.h"

#include <fmt/format.h>
#include <openvdb/tools/Interpolation.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {

constexpr double fewest_steps_per_call =
    1e-4;  // smallest step, as a share of the duration: a very high velocity must not take forever

/// A velocity field in which points move.
class Flow {
public:
    explicit Flow(const VectorGrid& velocity)
        : grid_(velocity),
          accessor_(velocity.getConstAccessor()),
          staggered_(velocity.getGridClass() == openvdb::GRID_STAGGERED) {}

    Vec3d at(const Vec3d& world) const {
        const auto index = near_place(grid_.worldToIndex(world));
        openvdb::Vec3s out;
        if (staggered_) openvdb::tools::StaggeredBoxSampler::sample(accessor_, index, out);
        else openvdb::tools::BoxSampler::sample(accessor_, index, out);
        if (!openvdb::math::isFinite(out))
            throw Failure(fmt::format("grid '{}' has a value that is not finite near {}",
                                      grid_.getName(), to_text(world)));
        return Vec3d(out);
    }

    /// Moves a point for `duration`.
    /// @param voxel  longest way of a step, world units
    /// @return nothing if the point starts in, or reaches, inactive velocity
    std::optional<Vec3d> moved(Vec3d p, double duration, double voxel) const {
        for (double left = duration; left > 0;) {
            if (!is_active(p)) return std::nullopt;
            const auto a = at(p);
            const double speed = a.length();
            if (speed == 0) return p;
            const double step =
                std::min(left, std::max(voxel / speed, fewest_steps_per_call * duration));
            const auto b = at(p + 0.5 * step * a), c = at(p + 0.5 * step * b), d = at(p + step * c);
            p += step / 6 * (a + 2.0 * b + 2.0 * c + d);
            left = step < left ? left - step : 0;
        }
        return is_active(p) ? std::optional(p) : std::nullopt;
    }

private:
    bool is_active(const Vec3d& world) const {
        const auto voxel = voxel_at(grid_.worldToIndex(world));
        return voxel && accessor_.isValueOn(*voxel);
    }

    const VectorGrid& grid_;
    VectorGrid::ConstAccessor accessor_;
    bool staggered_;
};

}  // namespace

std::vector<Vec3d> points_in_ball(const Vec3d& center, double radius, int count) {
    // A sequence that fills the cube evenly: multiples of powers of 1 / root, where root^4 = root +
    // 1.
    constexpr double root = 1.2207440846057596;
    std::vector<Vec3d> out;
    Vec3d sum(0);
    for (int n = 1; out.size() < static_cast<std::size_t>(count); ++n) {
        const auto part = [n](double by) { return 2 * (n * by - std::floor(n * by)) - 1; };
        const Vec3d in_cube(part(1 / root), part(1 / (root * root)),
                            part(1 / (root * root * root)));
        if (in_cube.length() > 1) continue;
        out.push_back(radius * in_cube);
        sum += out.back();
    }
    for (auto& point : out) point += center - sum / static_cast<double>(count);
    return out;
}

void advect(std::vector<Vec3d>& points, const VectorGrid& velocity, double duration) {
    const double voxel = shortest_edge(velocity.transform());
    std::vector<std::optional<Vec3d>> moved(points.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 16),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          const Flow flow(velocity);
                          for (auto n = range.begin(); n < range.end(); ++n)
                              moved[n] = flow.moved(points[n], duration, voxel);
                      });
    points.clear();
    for (const auto& point : moved)
        if (point) points.push_back(*point);
}

}  // namespace fluidcarve
