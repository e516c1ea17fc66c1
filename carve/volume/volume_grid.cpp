#include "carve/volume/volume_grid.h"

#include <openvdb/tools/Dense.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <vector>

namespace fluidcarve {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;

/// The tree of pixels, with one leaf per 8 x 8 voxels.
template <class GridT>
openvdb::GridBase::Ptr tree_of(const openvdb::GridBase& header, const ChannelPixels& pixels) {
    using Value = typename GridT::ValueType;
    using Leaf = typename GridT::TreeType::LeafNodeType;
    const auto& box = pixels.box;
    const int z = box.min().z();
    const auto first = Coord(box.min().x() >> 3, box.min().y() >> 3, z >> 3),
               last = Coord(box.max().x() >> 3, box.max().y() >> 3, 0);
    const int across = last.x() - first.x() + 1, rows = last.y() - first.y() + 1;
    std::vector<Leaf*> leaves(static_cast<std::size_t>(across) * static_cast<std::size_t>(rows));
    tbb::parallel_for(0, rows, [&](int row) {
        for (int column = 0; column < across; ++column) {
            const Coord origin((first.x() + column) * 8, (first.y() + row) * 8, first.z() * 8);
            auto* const leaf = new Leaf(origin, Value(0));
            for (int x = std::max(origin.x(), box.min().x());
                 x <= std::min(origin.x() + 7, box.max().x()); ++x)
                for (int y = std::max(origin.y(), box.min().y());
                     y <= std::min(origin.y() + 7, box.max().y()); ++y)
                    leaf->setValueOn(Leaf::coordToOffset({x, y, z}),
                                     std::bit_cast<Value>(pixels.at(x, y)));
            leaves[static_cast<std::size_t>(row) * static_cast<std::size_t>(across) +
                   static_cast<std::size_t>(column)] = leaf;
        }
    });
    auto out = openvdb::gridPtrCast<GridT>(header.copyGridWithNewTree());
    for (auto* const leaf : leaves) out->tree().addLeaf(leaf);
    return out;
}

/// The plane of a grid, if its active voxels fill a rectangle of one z.
template <class GridT>
std::shared_ptr<const ChannelPixels> pixels_of(const GridT& grid) {
    using Value = typename GridT::ValueType;
    const auto box = grid.evalActiveVoxelBoundingBox();
    if (box.empty() || box.min().z() != box.max().z() || grid.background() != Value(0) ||
        grid.activeVoxelCount() != box.volume())
        return nullptr;
    const auto values = std::make_shared<std::vector<float>>(box.volume());
    openvdb::tools::Dense<Value, openvdb::tools::LayoutXYZ> dense(
        box, reinterpret_cast<Value*>(values->data()));
    openvdb::tools::copyToDense(grid, dense);
    return std::make_shared<const ChannelPixels>(ChannelPixels{
        box, box, std::shared_ptr<const float>(values, values->data()), 1, box.dim().x()});
}

}  // namespace

VolumeGrid::VolumeGrid(openvdb::GridBase::ConstPtr header, ChannelPixels pixels)
    : grid_(std::move(header)), pixels_(std::make_shared<const ChannelPixels>(std::move(pixels))) {}

openvdb::GridBase::ConstPtr VolumeGrid::grid() const {
    if (!pixels_) return grid_;
    if (grid_->isType<openvdb::Int32Grid>()) return tree_of<openvdb::Int32Grid>(*grid_, *pixels_);
    return tree_of<openvdb::FloatGrid>(*grid_, *pixels_);
}

CoordBBox VolumeGrid::active_box() const {
    return pixels_ ? pixels_->box : grid_->evalActiveVoxelBoundingBox();
}

VolumeGrid VolumeGrid::holding(const openvdb::GridBase::ConstPtr& changed) const {
    VolumeGrid out(changed);
    if (!pixels_) return out;
    if (changed->isType<openvdb::FloatGrid>())
        out.pixels_ = pixels_of(static_cast<const openvdb::FloatGrid&>(*changed));
    else if (changed->isType<openvdb::Int32Grid>())
        out.pixels_ = pixels_of(static_cast<const openvdb::Int32Grid&>(*changed));
    if (out.pixels_) out.grid_ = changed->copyGridWithNewTree();
    return out;
}

std::uint64_t VolumeGrid::bytes() const {
    return pixels_ ? pixels_->stored.volume() * sizeof(float) : grid_->memUsage();
}

}  // namespace fluidcarve
