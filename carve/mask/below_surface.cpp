#include "carve/mask/below_surface.h"

#include "carve/base/failure.h"
#include "carve/base/values.h"
#include "carve/base/words.h"
#include "carve/field/extent.h"
#include "carve/field/same_transform.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>

namespace fluidcarve {

namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

using Leaf = openvdb::MaskTree::LeafNodeType;

constexpr int edge = Leaf::DIM;

/// The up direction as an axis of the voxels.
struct Up {
    int axis;
    int sign;      ///< 1 or -1: whether up is along or against the axis
    double voxel;  ///< edge of a voxel along the axis, world units
};

Up up_of(const FloatGrid& grid, const Vec3d& direction) {
    const auto& transform = grid.transform();
    const auto origin = transform.indexToWorld(Vec3d(0));
    for (int axis = 0; axis < 3 && transform.isLinear(); ++axis) {
        Vec3d next(0);
        next[axis] = 1;
        const auto step = transform.indexToWorld(next) - origin;
        const double along = step.dot(direction) / (step.length() * direction.length());
        if (std::abs(along) > 1 - 1e-9) return {axis, along > 0 ? 1 : -1, step.length()};
    }
    throw Failure(
        fmt::format("'up' ({}) runs along no axis of the voxels of grid '{}'; choose one "
                    "that does, or resample the grid",
                    numbers_text(direction), grid.getName()));
}

/// Computes the mask in one line of leaves along `up`, from the top down.
class Line {
public:
    Line(const std::vector<Ref<FloatGrid>>& surfaces, const CoordBBox& box, const Up& up, int depth)
        : surfaces_(surfaces), box_(box), up_(up), depth_(depth) {}

    /// @param block  origin of any leaf of the line
    /// @return the leaves that are not empty
    std::vector<std::unique_ptr<Leaf>> operator()(Coord block) const {
        std::vector<std::unique_ptr<Leaf>> out;
        constexpr int none = std::numeric_limits<int>::max();
        std::array<int, edge * edge>
            uppermost;  // height of the uppermost inside voxel of each line of voxels, along up
        uppermost.fill(none);
        const int a = up_.axis, first = box_.min()[a] & ~(edge - 1),
                  last = box_.max()[a] & ~(edge - 1);
        for (int n = 0; n <= (last - first) / edge; ++n) {
            block[a] = up_.sign > 0 ? last - n * edge : first + n * edge;
            auto leaf = std::make_unique<Leaf>(block);
            const auto inside = insides(block);
            for (int layer = 0; layer < edge; ++layer) {
                Coord at;
                at[a] = up_.sign > 0 ? edge - 1 - layer : layer;
                const int height = up_.sign * (block[a] + at[a]);
                std::size_t line = 0;
                for (at[(a + 1) % 3] = 0; at[(a + 1) % 3] < edge; ++at[(a + 1) % 3])
                    for (at[(a + 2) % 3] = 0; at[(a + 2) % 3] < edge; ++at[(a + 2) % 3]) {
                        auto& top = uppermost[line++];
                        const auto voxel = Leaf::coordToOffset(at);
                        if (top == none && inside.isOn(voxel)) top = height;
                        if (top != none && top - height >= depth_ && box_.isInside(block + at))
                            leaf->setValueOn(voxel);
                    }
            }
            if (!leaf->isEmpty()) out.push_back(std::move(leaf));
        }
        return out;
    }

private:
    Leaf::NodeMaskType insides(const Coord& block) const {
        Leaf::NodeMaskType out;
        for (const auto& surface : surfaces_) {
            if (const auto* const leaf = surface->tree().probeConstLeaf(block)) {
                for (openvdb::Index n = 0; n < Leaf::SIZE; ++n)
                    if (leaf->getValue(n) < 0) out.setOn(n);
            } else if (surface->tree().getValue(block) < 0) {
                out.setOn();
            }
        }
        return out;
    }

    const std::vector<Ref<FloatGrid>>& surfaces_;
    const CoordBBox& box_;
    const Up up_;
    const int depth_;
};

}  // namespace

MaskGrid::Ptr below_surface_mask(const std::vector<Ref<FloatGrid>>& surfaces,
                                 const Vec3d& direction, double depth) {
    const auto up = up_of(*surfaces.at(0), direction);
    CoordBBox box;
    for (std::size_t n = 0; n < surfaces.size(); ++n) {
        if (n > 0)
            require_same_transform(fmt::format("surfaces 1 and {}", n + 1), *surfaces[0],
                                   *surfaces[n]);
        if (surfaces[n]->getGridClass() == openvdb::GRID_FOG_VOLUME)
            throw Failure(
                fmt::format("grid '{}' is a fog volume, which has no surface; connect a level set, "
                            "such as sdf.from_mesh makes",
                            surfaces[n]->getName()));
        if (CoordBBox known; surfaces[n]->tree().evalActiveVoxelBoundingBox(known)) {
            require_near(surfaces[n]->getName(), known);
            box.expand(known);
        }
    }
    auto out = MaskGrid::create();
    out->setTransform(surfaces[0]->transform().copy());
    out->setName("below");
    if (box.empty()) return out;

    require_walkable("the space around the surfaces", box, up.axis);
    const int b = (up.axis + 1) % 3, c = (up.axis + 2) % 3;
    std::vector<Coord> lines;
    auto block = box.min() & ~(edge - 1);
    const auto first = block;
    for (block[b] = first[b]; block[b] <= box.max()[b]; block[b] += edge)
        for (block[c] = first[c]; block[c] <= box.max()[c]; block[c] += edge)
            lines.push_back(block);
    std::vector<std::vector<std::unique_ptr<Leaf>>> leaves(lines.size());
    const Line line(surfaces, box, up,
                    static_cast<int>(std::min(std::round(depth / up.voxel), 2.0 * farthest_voxel)));
    tbb::parallel_for(std::size_t{0}, lines.size(),
                      [&](std::size_t n) { leaves[n] = line(lines[n]); });
    for (auto& all : leaves)
        for (auto& leaf : all) {
            if (leaf->isDense()) out->tree().addTile(1, leaf->origin(), true, true);
            else out->tree().addLeaf(leaf.release());
        }
    return out;
}

}  // namespace fluidcarve
