#include "carve/solver/costs/content.h"

#include "carve/lattice/mapping.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace fluidcarve {

namespace {

using openvdb::Coord;
using openvdb::Vec3d;
using Leaf = openvdb::FloatTree::LeafNodeType;

/// Decides whether a place is in a lattice, or near its rims.
class Reach {
public:
    Reach(const Lattice& lattice, double voxel_size)
        : margin_(
              std::clamp(voxel_size / lattice.spacing, 1.0, static_cast<double>(most_vertices)) /
                  2 +
              hair),
          around_(lattice.around),
          // A mapping can't locate places before its first vertices.
          before_(around_ ? 0 : static_cast<int>(std::ceil(margin_))),
          shape_(lattice.shape),
          mapping_(lattice.is_box() ? Mapping(lattice)
                                    : bent(lattice, static_cast<int>(std::ceil(margin_)))),
          box_(lattice.is_box()) {}

    bool operator()(const Vec3d& world) const {
        if (box_) {
            const auto at = mapping_.coordinates(world);
            return within(at.x(), 0) && within(at.y(), 1) && within(at.z(), 2);
        }
        const auto at = mapping_.locate(world);
        return at && within(at->x() - before_, 0) && (around_ || within(at->y() - before_, 1));
    }

private:
    static constexpr double hair = 1e-3;  ///< vertices

    /// @param more  vertices beyond each rim
    static Mapping bent(const Lattice& lattice, int more) {
        if (lattice.around)
            return {lattice, {lattice.shape[0] + more, lattice.shape[1], lattice.shape[2]}};
        const auto wider = extended(lattice, {more, more, 0}, 0);
        return {wider, {wider.shape[0] + more, wider.shape[1] + more, wider.shape[2]}};
    }
    bool within(double at, std::size_t dimension) const {
        return at >= -margin_ && at <= shape_[dimension] - 1 + margin_;
    }

    const double margin_;  ///< vertices
    const bool around_;
    const int before_;  ///< vertices of the mapping before the lattice's first
    const std::array<int, 3> shape_;
    const Mapping mapping_;
    const bool box_;
};

/// A leaf or an active tile, as 8 x 8 x 8 slots.
struct Block {
    openvdb::CoordBBox box;
    const Leaf* leaf;  ///< null: a tile
};

std::vector<Block> blocks_of(const openvdb::FloatTree& tree) {
    std::vector<Block> out;
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf)
        out.push_back({leaf->getNodeBoundingBox(), leaf.getLeaf()});
    auto tile = tree.cbeginValueOn();
    tile.setMaxDepth(decltype(tile)::LEAF_DEPTH - 1);
    for (; tile; ++tile) out.push_back({tile.getBoundingBox(), nullptr});
    return out;
}

}  // namespace

Content content_in(const openvdb::FloatGrid& grid, const Lattice& lattice) {
    constexpr std::size_t slots = Leaf::SIZE, most_looked_at = std::size_t{1} << 16;
    Content out{grid.activeVoxelCount(), 0};
    if (out.voxels == 0) return out;
    const auto& transform = grid.transform();
    const auto size = transform.voxelSize();
    const Reach reaches(lattice, std::max({size.x(), size.y(), size.z()}));
    const auto blocks = blocks_of(grid.tree());
    // Odd, so that it meets all rows of a block in turn.
    const auto stride = (blocks.size() * slots / most_looked_at) | 1;
    double seen = 0, inside = 0;
    for (std::size_t slot = 0; slot < blocks.size() * slots; slot += stride) {
        const auto& block = blocks[slot / slots];
        const auto n = static_cast<openvdb::Index>(slot % slots);
        if (block.leaf && !block.leaf->isValueOn(n)) continue;
        // Of a slot, in voxels. A box may end at the last voxel of index space, where dim() would
        // overflow.
        const double width =
            (static_cast<double>(block.box.max().x()) - block.box.min().x() + 1) / 8;
        const auto at = block.box.min().asVec3d() + width * Leaf::offsetToLocalCoord(n).asVec3d() +
                        Vec3d((width - 1) / 2);
        const double voxels = width * width * width;
        seen += voxels;
        if (reaches(transform.indexToWorld(at))) inside += voxels;
    }
    // If voxels are sparse, none may lie in the sampled slots.
    out.inside = static_cast<double>(out.voxels) * (seen > 0 ? inside / seen : 1);
    return out;
}

}  // namespace fluidcarve
