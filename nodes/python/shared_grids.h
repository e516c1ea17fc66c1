#pragma once

#include "nodes/payloads.h"
#include "nodes/python/worker.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// Grids of one frame as a script sees them: leaves of 8 x 8 x 8 voxels that all of them share, with all voxels that are active in any of them. Active tiles
/// become voxels; a mask is 1 and 0, a staggered vector grid is collocated.
class SharedGrids {
public:
    /// @param inputs  one or more, by name: float, vector or mask, all with the same transform
    /// @param budget  limit of what they take, bytes
    /// @throws Failure naming an input of another type, two inputs with different transforms, or one that is too large
    SharedGrids(const std::vector<std::pair<std::string, Ref<AnyGrid>>>& inputs, std::uint64_t budget);

    /// Writes all grids into the worker's memory. @return what the request says of them
    nlohmann::json write(Worker& worker) const;

    /// The numbers that the worker has left, one for each voxel of the leaves. @return a grid with the active voxels of all inputs; 0 elsewhere
    FloatGrid::Ptr numbers(Worker& worker) const;
    /// The leaves of states that the worker has left. @param leaves  their number
    MaskGrid::Ptr states(Worker& worker, std::uint64_t leaves) const;

private:
    nlohmann::json write_grid(const openvdb::GridBase& grid, std::byte* data, std::uint64_t& at) const;

    std::vector<std::pair<std::string, openvdb::GridBase::ConstPtr>> grids_;
    openvdb::MaskTree::Ptr voxels_;  ///< active voxels of all grids, without tiles
    std::vector<const openvdb::MaskTree::LeafNodeType*> leaves_;
    std::uint64_t bytes_ = 0;
};

}  // namespace fluidcarve
