#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

namespace fluidcarve {

/// The values of a picture's channel as an array. A tree would take eight times the memory: its
/// leaves are eight voxels deep.
struct ChannelPixels {
    openvdb::CoordBBox box;  ///< the active voxels, all of one z
    /// The voxels with stored values; the other voxels of `box` are 0. May be empty.
    openvdb::CoordBBox stored;
    std::shared_ptr<const float> values;  ///< the value of the voxel `stored.min()`, and the
                                          ///< others by along_x and along_y; integers as bits
    std::ptrdiff_t along_x = 0,
                   along_y = 0;  ///< from the value of a voxel to that of its neighbour

    /// @param x, y  of a voxel in `box`
    float at(int x, int y) const {
        const auto& low = stored.min();
        return stored.isInside({x, y, low.z()})
                   ? values.get()[(x - low.x()) * along_x + (y - low.y()) * along_y]
                   : 0.0f;
    }
};

/// One grid of a volume: a tree, or the pixels of a picture's channel, which become a tree only on
/// request.
class VolumeGrid {
public:
    VolumeGrid() = default;
    template <class GridT>
    VolumeGrid(std::shared_ptr<GridT> grid) : grid_(std::move(grid)) {}
    /// @param header  a grid of floats or of whole numbers (Int32Grid) without voxels and with a
    ///   background of 0
    VolumeGrid(openvdb::GridBase::ConstPtr header, ChannelPixels pixels);

    /// Type, name, transform and metadata of the grid, perhaps without its voxels.
    const openvdb::GridBase& header() const { return *grid_; }
    std::string name() const { return grid_->getName(); }
    /// The grid. Pixels are converted anew by each call.
    openvdb::GridBase::ConstPtr grid() const;
    operator openvdb::GridBase::ConstPtr() const { return grid(); }
    openvdb::GridBase::ConstPtr operator->() const { return grid(); }
    explicit operator bool() const { return grid_ != nullptr; }
    /// Null if the grid is a tree.
    const ChannelPixels* pixels() const { return pixels_.get(); }
    /// Box around the active voxels, index coordinates; empty if there are none. Makes no tree.
    openvdb::CoordBBox active_box() const;
    /// A changed grid, held as this one is: as pixels if this is so, and the grid's active voxels
    /// fill a rectangle of one z.
    VolumeGrid holding(const openvdb::GridBase::ConstPtr& changed) const;
    /// Bytes of memory.
    std::uint64_t bytes() const;
    /// Whether both are the same grid, not only alike.
    bool operator==(const VolumeGrid&) const = default;

private:
    openvdb::GridBase::ConstPtr grid_;
    std::shared_ptr<const ChannelPixels> pixels_;
};

}  // namespace fluidcarve
