#include "carve/lattice/content_reach.h"

#include "carve/base/median.h"
#include "carve/field/extent.h"
#include "carve/field/shown_part.h"
#include "carve/lattice/directions.h"
#include "carve/lattice/resample.h"
#include "carve/volume/cubes.h"

#include <openvdb/tree/LeafManager.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace fluidcarve {

namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

/// The lowest and the highest value added.
struct Range {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    void add(const Range& other) {
        low = std::min(low, other.low);
        high = std::max(high, other.high);
    }
    bool empty() const { return low > high; }
};

/// The ranges that the voxels nearest to a plane cover along its axes.
struct Covered {
    Range u, v, w;
};

/// The planes across a rig, a voxel apart.
class Planes {
public:
    Planes(const Rig& rig, double spacing) : line_(resampled(rig, spacing)), open_(!rig.closed) {
        w_ = plane_directions(line_, rig.closed, false);
        v_ = untwisted(line_, w_, rig.closed, rig.up);
    }

    std::size_t count() const { return w_.size(); }
    bool open() const { return open_; }

    /// The planes that may be the nearest to a point within `radius` of another point.
    std::vector<std::size_t> near(const Vec3d& point, double radius) const {
        double least = std::numeric_limits<double>::infinity();
        for (const auto& origin : line_.points) least = std::min(least, (point - origin).length());
        std::vector<std::size_t> out;
        for (std::size_t k = 0; k < count(); ++k)
            if ((point - line_.points[k]).length() <= least + 2 * radius) out.push_back(k);
        return out;
    }

    /// Adds a point to the ranges of the nearest of some planes.
    void cover(const Vec3d& point, const std::vector<std::size_t>& among,
               std::vector<Covered>& covered) const {
        const auto k = *std::ranges::min_element(among, {}, [&](std::size_t plane) {
            return (point - line_.points[plane]).lengthSqr();
        });
        const auto offset = point - line_.points[k];
        const auto add = [&](Range& range, const Vec3d& axis) {
            const double at = offset.dot(axis);
            range.add({at, at});
        };
        add(covered[k].u, v_[k].cross(w_[k]));
        add(covered[k].v, v_[k]);
        add(covered[k].w, w_[k]);
    }

private:
    Resampled line_;
    std::vector<Vec3d> w_, v_;
    bool open_;
};

/// Gathers the ranges of all visible voxels of a grid.
class Gather {
public:
    Gather(const FloatGrid& grid, const Planes& planes)
        : grid_(grid), planes_(planes), shown_(grid) {}

    std::vector<Covered> run() const {
        const openvdb::tree::LeafManager<const FloatGrid::TreeType> leaves(grid_.tree());
        auto out = tbb::parallel_reduce(
            leaves.leafRange(), std::vector<Covered>(planes_.count()),
            [&](const auto& range, std::vector<Covered> covered) {
                for (auto leaf = range.begin(); leaf; ++leaf) add_leaf(*leaf, covered);
                return covered;
            },
            [](std::vector<Covered> a, const std::vector<Covered>& b) {
                for (std::size_t k = 0; k < a.size(); ++k) {
                    a[k].u.add(b[k].u);
                    a[k].v.add(b[k].v);
                    a[k].w.add(b[k].w);
                }
                return a;
            });
        add_tiles(out);
        return out;
    }

private:
    std::vector<std::size_t> planes_near(const CoordBBox& box) const {
        const auto corner = grid_.indexToWorld(box.min()), other = grid_.indexToWorld(box.max());
        return planes_.near((corner + other) / 2, (other - corner).length() / 2);
    }

    template <class Leaf>
    void add_leaf(const Leaf& leaf, std::vector<Covered>& covered) const {
        std::vector<std::size_t> near;
        for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) {
            if (!shown_(*voxel)) continue;
            if (near.empty()) near = planes_near(leaf.getNodeBoundingBox());
            planes_.cover(grid_.indexToWorld(voxel.getCoord()), near, covered);
        }
    }

    /// Adds the corners of parts of tiles. Parts are as large as leaves, but at most a few
    /// thousand per tile.
    void add_tiles(std::vector<Covered>& covered) const {
        constexpr int leaf = FloatGrid::TreeType::LeafNodeType::DIM, most_along = 16;
        auto tile = grid_.tree().cbeginValueOn();
        tile.setMaxDepth(decltype(tile)::LEAF_DEPTH - 1);
        for (; tile; ++tile) {
            if (!shown_(*tile)) continue;
            const auto box = tile.getBoundingBox();
            // In 64 bits, since a tile may end where coordinates do.
            const std::int64_t step = std::max<std::int64_t>(leaf, box.dim().x() / most_along);
            for (std::int64_t x = box.min().x(); x < box.max().x(); x += step)
                for (std::int64_t y = box.min().y(); y < box.max().y(); y += step)
                    for (std::int64_t z = box.min().z(); z < box.max().z(); z += step) {
                        const Coord corner_of_part(static_cast<int>(x), static_cast<int>(y),
                                                   static_cast<int>(z));
                        const auto part =
                            CoordBBox::createCube(corner_of_part, static_cast<int>(step));
                        const auto near = planes_near(part);
                        for (int n = 0; n < 8; ++n) {
                            const Coord corner((n & 1 ? part.max() : part.min()).x(),
                                               (n & 2 ? part.max() : part.min()).y(),
                                               (n & 4 ? part.max() : part.min()).z());
                            planes_.cover(grid_.indexToWorld(corner), near, covered);
                        }
                    }
        }
    }

    const FloatGrid& grid_;
    const Planes& planes_;
    ShownPart shown_;
};

}  // namespace

std::optional<ContentReach> content_reach(const FloatGrid& grid, const Rig& rig) {
    const double voxel = shortest_edge(grid.transform());
    const Planes planes(rig, voxel);
    const auto covered = Gather(grid, planes).run();
    std::vector<double> u, v;
    // Content nearest to an end plane may lie anywhere beyond it.
    const std::size_t end = planes.open() ? 1 : 0;
    for (auto k = end; k + end < covered.size(); ++k) {
        if (covered[k].u.empty()) continue;
        u.push_back(covered[k].u.high - covered[k].u.low + voxel);
        v.push_back(covered[k].v.high - covered[k].v.low + voxel);
    }
    if (u.empty()) return std::nullopt;
    ContentReach out{median_of(std::move(u)), median_of(std::move(v))};
    if (planes.open()) {
        out.before = std::max(0.0, -covered.front().w.low);
        out.after = std::max(0.0, covered.back().w.high);
    }
    return out;
}

}  // namespace fluidcarve
