#include "carve/mask/convex.h"

#include "carve/base/failure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>

namespace fluidcarve {
namespace {

using openvdb::BBoxd;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;
using Tree = openvdb::MaskTree;

constexpr std::array block_edges = {1, 8, 128, 4096};  // edge of a tile in voxels, by level
constexpr double most_blocks = 1e6;  // maximum number of leaves along a border: about 100 MB

std::array<Vec3d, 8> corners(const Vec3d& low, const Vec3d& high) {
    std::array<Vec3d, 8> out;
    for (std::size_t n = 0; n < 8; ++n)
        out[n] = Vec3d((n & 4 ? high : low)[0], (n & 2 ? high : low)[1], (n & 1 ? high : low)[2]);
    return out;
}

/// Fills a mask with the voxels of a shape, block by block from large to small.
class Filler {
public:
    Filler(Tree& tree, const openvdb::math::Transform& transform, const Convex& shape,
           const CoordBBox& voxels)
        : tree_(tree), transform_(transform), shape_(shape), voxels_(voxels) {}

    void fill(const Coord& origin, openvdb::Index level) {
        const auto block = CoordBBox::createCube(origin, block_edges[level]);
        if (!block.hasOverlap(voxels_)) return;
        BBoxd place;
        bool whole = true;
        for (const auto& corner : corners(block.min().asVec3d(), block.max().asVec3d())) {
            const auto at = transform_.indexToWorld(corner);
            place.expand(at);
            whole = whole && shape_.holds(at);
        }
        if (whole) return tree_.addTile(level, origin, true, true);
        if (!shape_.touches(place)) return;
        if (level == 1) return fill_leaf(block);
        const int edge = block_edges[level - 1];
        for (int x = block.min().x(); x < block.max().x(); x += edge)
            for (int y = block.min().y(); y < block.max().y(); y += edge)
                for (int z = block.min().z(); z < block.max().z(); z += edge)
                    fill({x, y, z}, level - 1);
    }

private:
    void fill_leaf(const CoordBBox& block) {
        auto leaf = std::make_unique<Tree::LeafNodeType>(block.min());
        for (auto at = block.begin(); at; ++at)
            if (shape_.holds(transform_.indexToWorld(*at))) leaf->setValueOn(*at);
        if (!leaf->isEmpty()) tree_.addLeaf(leaf.release());
    }

    Tree& tree_;
    const openvdb::math::Transform& transform_;
    const Convex& shape_;
    CoordBBox voxels_;
};

CoordBBox voxels_around(const openvdb::GridBase& like, const Convex& shape) {
    BBoxd range;
    for (const auto& corner : corners(shape.bounds.min(), shape.bounds.max()))
        range.expand(like.transform().worldToIndex(corner));
    const auto size = range.extents() + Vec3d(1);
    const double blocks = 2 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0]) / 64;
    double farthest = 0;
    for (int n = 0; n < 3; ++n)
        farthest = std::max({farthest, std::abs(range.min()[n]), std::abs(range.max()[n])});
    if (!(blocks <= most_blocks && farthest < 1e9)) {
        const auto whole = [](double place) { return std::round(place) + 0.0; };  // no -0
        const auto text = [&](const Vec3d& at) {
            return fmt::format("[{:.0f}, {:.0f}, {:.0f}]", whole(at[0]), whole(at[1]),
                               whole(at[2]));
        };
        throw Failure(
            fmt::format("the {} reaches from voxel {} to {} of grid '{}', which is more than a "
                        "mask can hold; make it smaller: it needs to cover only the lattice",
                        shape.name, text(range.min()), text(range.max()), like.getName()));
    }
    return {Coord::floor(range.min()), Coord::ceil(range.max())};
}

}  // namespace

double convex_slack(const openvdb::GridBase& like) {
    const auto size = like.voxelSize();
    return 1e-5 * std::min({size[0], size[1], size[2]});
}

MaskGrid::Ptr convex_mask(const openvdb::GridBase& like, const Convex& shape) {
    if (!like.transform().isLinear())
        throw Failure(
            fmt::format("grid '{}' has voxels of varying shape ({}); a {} needs voxels of one "
                        "shape, as grid.resample makes them",
                        like.getName(), like.transform().mapType(), shape.name));
    const auto voxels = voxels_around(like, shape);
    const auto out = MaskGrid::create();
    out->setTransform(like.transform().copy());
    out->setName(shape.name);
    Filler filler(out->tree(), like.transform(), shape, voxels);
    constexpr int edge = block_edges[3];
    const auto first = voxels.min() & ~(edge - 1);
    for (int x = first.x(); x <= voxels.max().x(); x += edge)
        for (int y = first.y(); y <= voxels.max().y(); y += edge)
            for (int z = first.z(); z <= voxels.max().z(); z += edge) filler.fill({x, y, z}, 3);
    return out;
}

}  // namespace fluidcarve
