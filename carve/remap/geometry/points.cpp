#include "carve/remap/geometry/points.h"

#include "carve/base/unit_hash.h"
#include "carve/remap/finish/derivative.h"
#include "carve/seam/carve_inverse.h"
#include "carve/seam/joins.h"
#include "carve/seam/step_columns.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace fluidcarve {
namespace {

using openvdb::Vec2d;
using openvdb::Vec3d;

/// Reflects a coordinate that lies beyond an interval back into it.
double reflected(double x, const Vec2d& room) {
    if (x < room[0]) x = 2 * room[0] - x;
    if (x > room[1]) x = 2 * room[1] - x;
    return std::clamp(x, room[0], room[1]);
}

/// Whether a box holds a point, border included; BBoxd::isInside leaves out the border.
bool reaches(const openvdb::BBoxd& box, const Vec3d& at) {
    for (int n = 0; n < 3; ++n)
        if (at[n] < box.min()[n] || at[n] > box.max()[n]) return false;
    return true;
}

/// Not the unit_hash() by which blends in time choose points: carves choose independently of them.
double chance(std::uint64_t identity) { return unit_hash(identity ^ 0x5eedu); }

/// A point that passes through the steps.
struct MovedPoint {
    Vec3d at;
    std::uint64_t copy;  ///< 0: the point itself; else the number of the copy
};

/// Displaces copies at random.
class Jitter {
public:
    explicit Jitter(double amount) : amount_(amount) {}

    /// @param room  interval along the carved axis in which the copy must stay
    Vec3d operator()(const Vec3d& at, const CarveStep& step, const Vec2d& room,
                     std::uint64_t seed) const {
        if (amount_ == 0) return at;
        const auto& columns = step.columns();
        auto out = at;
        for (int n = 0; n < 3; ++n) {
            const double by = amount_ * (2 * unit_hash(seed) - 1);
            seed = mixed_bits(seed);
            const auto wrapped = [&](int size) {
                return at[n] + by - size * std::floor((at[n] + by) / size);
            };
            if (n == step.axis()) out[n] = reflected(at[n] + by, room);
            else if (n == columns.lateral_axis() && columns.around)
                out[n] = wrapped(columns.laterals);
            else if (n == columns.lateral_axis())
                out[n] = columns.laterals > 1 ? reflected(at[n] + by, Vec2d(columns.first_lateral,
                                                                            columns.last_lateral()))
                                              : at[n];
            else if (columns.closed) out[n] = wrapped(columns.slices);
            else
                out[n] =
                    columns.slices > 1
                        ? reflected(at[n] + by, Vec2d(columns.first_slice, columns.last_slice()))
                        : at[n];
        }
        return out;
    }

private:
    double amount_;
};

/// Carves points under a smoothed map. Each point moves with its place. Points are thinned in
/// proportion to the compression of space, and copied in proportion to its stretching. The points'
/// identities decide which.
class SoftCarve {
public:
    SoftCarve(const Mapping& mapping, const CarveMap& map, const Jitter& jitter)
        : mapping_(mapping), map_(map), jitter_(jitter) {}

    /// Finds the ways of a point and its copies; none if the point is deleted.
    /// @param from  lattice index coordinates, where something moves
    void operator()(const Vec3d& from, std::uint64_t identity,
                    std::vector<MovedPoint>& ways) const {
        ways.clear();
        auto to = from;
        double pressed = 1;
        for (const auto& step : map_.steps()) {
            const double u = to[step.axis()];
            // An insertion overwrites content beyond the lattice's ends.
            if (step.holds(to) && (u < step.origin() || u > step.last_before()) &&
                step.carves(to, step.rim_scale(to)))
                return;
            to[step.axis()] = carved_coordinate(step, to);
            if (step.holds(to) && to[step.axis()] != u) pressed *= slope(step, to);
        }
        if (to == from) {
            ways.push_back({to, 0});
            return;
        }
        // In bent lattices, cells differ in size.
        pressed *=
            std::abs(position_slope(mapping_, from).det() / position_slope(mapping_, to).det());
        // Mean number of points in place of one, so that the density stays the same.
        const double wanted = 1 / std::max(pressed, 1e-3);
        const auto whole = static_cast<std::uint64_t>(wanted);
        const auto count = whole + (chance(identity) < wanted - static_cast<double>(whole) ? 1 : 0);
        const auto& step = map_.steps().back();
        for (std::uint64_t copy = 0; copy < count; ++copy) {
            if (copy == 0) {
                ways.push_back({to, 0});
                continue;
            }
            const auto seed = mixed_bits(identity) ^ mixed_bits(copy);
            auto beside = to;
            beside[step.axis()] += (seed & 1) != 0 ? 0.5 : -0.5;
            ways.push_back(
                {jitter_(beside, step, {step.start() - 0.5, step.last() + 0.5}, seed), copy});
        }
    }

private:
    /// Slope of the map along a step's axis. The map is linear between entries.
    static double slope(const CarveStep& step, const Vec3d& at) {
        const StepColumns columns(step, at);
        const int entry = std::clamp(static_cast<int>(std::floor(at[step.axis()])), step.start(),
                                     std::max(step.start(), step.last() - 1));
        return 1 +
               step.rim_scale(at) * (columns.displacement(entry + 1) - columns.displacement(entry));
    }

    const Mapping& mapping_;
    const CarveMap& map_;
    const Jitter& jitter_;
};

/// Whether a step leaves a point where it is, since the point lies beyond all that the step moves.
/// @param scale, ends  of the step, there
bool stays(const CarveStep& step, const Vec3d& at, double scale, const CarveStep::Ends& ends) {
    const double u = at[step.axis()];
    const auto [first, last] = ends;
    return !step.holds(at) || scale == 0 || u < std::min<double>(first, step.origin()) ||
           u > std::max<double>(last, step.last_before());
}

/// Finds the places of a point after a step whose seams are joined by a fade.
/// @param places, rooms  as for carve_point()
void join_point(const CarveStep& step, const Vec3d& at, double share, std::vector<double>& places,
                std::vector<Vec2d>& rooms) {
    constexpr double around = 0.5;  // vertices, within which the blend hardly changes
    places.clear();
    rooms.clear();
    const double u = at[step.axis()], scale = step.rim_scale(at);
    if (stays(step, at, scale, step.ends(at, scale))) places.push_back(u);
    else if (u >= step.origin() && u <= step.last_before())
        step.joins()->places(step, at, share, places);
    for (const double place : places) rooms.emplace_back(place - around, place + around);
}

/// Carves points one by one.
class PointsCarve {
public:
    /// Some points' images, and counts of them.
    struct Part {
        std::vector<PointImage> images;
        std::size_t moved = 0, deleted = 0, copied = 0;
    };
    /// Memory for one point after the other.
    struct Scratch {
        std::vector<MovedPoint> ways, next;
        std::vector<double> places;
        std::vector<Vec2d> rooms;
    };

    PointsCarve(const Lattice& lattice, const CarveMap& map, double jitter)
        : map_(map),
          mapping_(map.extended(lattice), map.reach()),
          moves_(map.moved()),
          jitter_(jitter),
          joined_(std::ranges::all_of(
              map.steps(), [](const CarveStep& step) { return step.joins() != nullptr; })) {
        if (map.soft() && !joined_) soft_.emplace(mapping_, map_, jitter_);
    }

    void operator()(std::uint32_t source, const Vec3d& position, std::uint64_t identity, Part& out,
                    Scratch& scratch) const {
        const auto from = mapping_.locate(position);
        if (!from || !reaches(moves_, *from)) return out.images.push_back({source, false, {}});
        auto& ways = scratch.ways;
        ways = {{*from, 0}};
        if (soft_) (*soft_)(*from, identity, ways);
        else
            for (std::size_t s = 0; s < map_.steps().size(); ++s) pass_step(s, identity, scratch);
        // The point itself comes first. A later step may take it and leave its copies.
        out.deleted += ways.empty() || ways.front().copy != 0;
        for (const auto& way : ways) {
            const bool moved = way.at != *from;
            out.images.push_back(
                {source, moved,
                 moved ? position + mapping_.position(way.at) - mapping_.position(*from)
                       : Vec3d(0)});
            if (way.copy != 0) ++out.copied;
            else out.moved += moved;
        }
    }

private:
    /// Finds the ways of a point and its copies through a step.
    void pass_step(std::size_t s, std::uint64_t identity, Scratch& scratch) const {
        auto& [ways, next, places, rooms] = scratch;
        const auto& step = map_.steps()[s];
        next.clear();
        for (const auto& way : ways) {
            if (joined_) join_point(step, way.at, chance(identity ^ s), places, rooms);
            else carve_point(step, way.at, places, rooms);
            for (std::size_t p = 0; p < places.size(); ++p) {
                auto to = way.at;
                to[step.axis()] = places[p];
                if (p == 0) next.push_back({to, way.copy});
                else {
                    const auto copy = mixed_bits(way.copy + 0x10000 * (s + 1) + p);
                    next.push_back(
                        {jitter_(to, step, rooms[p], mixed_bits(identity) ^ copy), copy});
                }
            }
        }
        ways.swap(next);
    }

    const CarveMap& map_;
    const Mapping mapping_;
    const openvdb::BBoxd moves_;
    const Jitter jitter_;
    /// If one of the steps is a warp, seams squeeze points as the warp does.
    const bool joined_;
    std::optional<SoftCarve> soft_;
};

}  // namespace

void carve_point(const CarveStep& step, const Vec3d& at, std::vector<double>& places,
                 std::vector<Vec2d>& rooms) {
    places.clear();
    rooms.clear();
    const double u = at[step.axis()];
    const auto stay = [&] {
        places.push_back(u);
        rooms.emplace_back(u, u);
    };
    const double scale = step.rim_scale(at);
    const auto ends = step.ends(at, scale);
    if (stays(step, at, scale, ends)) return stay();
    if (u < step.origin() || u > step.last_before()) return;  // an insertion overwrites it

    // The content at `u*` comes from `u* + scale d`, where `d` is a whole number between the bounds
    // of seams. The places of a point are all `u*` whose content comes from it. They are searched
    // from bound to bound; their sources never fall.
    const auto [first, last] = ends;
    const StepColumns bounds(step, at);
    const auto inserts = [&](std::size_t n) {
        return step.inserts() == (n < static_cast<std::size_t>(step.count()));
    };
    const auto bound = [&](std::size_t n) { return bounds.bound(n) - (inserts(n) ? 0 : 0.5); };
    const auto d = [&](std::size_t passed) {
        const int ahead = static_cast<int>(passed),
                  back = step.paired() ? std::max(ahead - step.count(), 0) : 0;
        return (step.inserts() ? -1 : 1) * (ahead - 2 * back) + step.origin() - step.start();
    };
    // A point on a bound counts as beyond it, even if rounding moved it there: so a seam takes or
    // doubles one layer of particles that lie on vertices, or half a vertex beside them. Near a
    // rim, seams may be narrower than snap_width.
    const double near = std::min(snap_width, scale / 4);
    const auto beyond = [&](double place, std::size_t n) { return place >= bound(n) - near; };
    for (std::size_t passed = 0; passed <= bounds.size(); ++passed) {
        const double place = u - scale * d(passed);
        if (passed > 0 && !beyond(place, passed - 1)) break;
        if (passed < bounds.size() && beyond(place, passed)) continue;
        if (place < first || place > last) continue;
        places.push_back(place);
        const double from = passed > 0 ? bound(passed - 1) : first;
        rooms.emplace_back(from, std::min(from + scale, last));
    }
}

CarvedPoints carve_points(const std::vector<Vec3d>& positions,
                          const std::vector<std::uint64_t>& identities, const Lattice& lattice,
                          const CarveMap& map, double jitter) {
    const PointsCarve carve(lattice, map, jitter);
    constexpr std::size_t grain = 4096;
    std::vector<PointsCarve::Part> parts((positions.size() + grain - 1) / grain);
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t p) {
        PointsCarve::Scratch scratch;
        for (auto n = p * grain; n < std::min(positions.size(), (p + 1) * grain); ++n)
            carve(static_cast<std::uint32_t>(n), positions[n], identities[n], parts[p], scratch);
    });

    CarvedPoints out;
    for (const auto& part : parts) {
        out.images.insert(out.images.end(), part.images.begin(), part.images.end());
        out.moved += part.moved;
        out.deleted += part.deleted;
        out.copied += part.copied;
    }
    return out;
}

}  // namespace fluidcarve
