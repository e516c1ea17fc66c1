#pragma once

#include "carve/base/values.h"
#include "carve/volume/volume.h"
#include "nodes/python/worker.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// Grids of one frame as a script sees them: leaves of 8 x 8 x 8 voxels that all of them share,
/// with all voxels that are active in any of them. Active tiles become voxels; a mask is 1 and 0, a
/// staggered vector grid is collocated.
class SharedGrids {
public:
    /// @param inputs  one or more, by name: float, vector or mask, all with the same transform
    /// @param budget  limit of the memory of all grids, and of a part; bytes
    /// @throws Failure naming an input of another type, two inputs with different transforms, or
    ///   one that is too large
    SharedGrids(const std::vector<std::pair<std::string, Ref<AnyGrid>>>& inputs,
                std::uint64_t budget);

    /// Leaves that a script gets at once.
    struct Part {
        std::vector<std::size_t> leaves;  ///< indices, rising; those of neighbours, too
        openvdb::CoordBBox box;           ///< of voxels, neighbours included
        /// The lowest voxel of the block whose results are wanted; nothing: all are.
        std::optional<openvdb::Coord> block;
        /// Whether results of a leaf are wanted. @param origin  of the leaf
        bool wants(const openvdb::Coord& origin) const;
    };
    /// All leaves as one part; or, with a halo, parts of at most 64 x 64 x 64 voxels, each with
    /// the voxels within `halo` of it.
    /// @param halo  voxels; nothing: one part
    std::vector<Part> parts(std::optional<int> halo) const;

    /// Writes all grids into the worker's memory. @return their description for the request
    /// @throws Failure if they take more than the budget
    nlohmann::json write(Worker& worker, const Part& part) const;

    /// Makes a grid of the numbers that a worker returns, one for each voxel of a part's leaves:
    /// it has the active voxels of all inputs, and is 0 elsewhere.
    class Numbers {
    public:
        /// @param least  smallest allowed number, or -infinity
        Numbers(const SharedGrids& grids, float least);
        void take(Worker& worker, const Part& part);
        FloatGrid::Ptr grid;
        std::atomic<bool> good = true;  ///< all numbers are finite, and at least `least`

    private:
        const SharedGrids& grids_;
        float least_;
    };

    /// Adds the leaves of states that the worker returned to a mask. @param leaves  their number
    void add_states(MaskGrid& mask, Worker& worker, std::uint64_t leaves, const Part& part) const;
    /// The transform of all grids.
    const openvdb::math::Transform& transform() const { return grids_.front().second->transform(); }

private:
    nlohmann::json write_grid(const openvdb::GridBase& grid, const Part& part, std::byte* data,
                              std::uint64_t& at) const;
    /// Bytes that a number of leaves take.
    std::uint64_t bytes(std::size_t leaves) const;

    std::vector<std::pair<std::string, openvdb::GridBase::ConstPtr>> grids_;
    openvdb::MaskTree::Ptr voxels_;  ///< active voxels of all grids, without tiles
    std::vector<const openvdb::MaskTree::LeafNodeType*> leaves_;
    openvdb::CoordBBox box_;  ///< of all active voxels; if there are none, from 0 to -1
    std::uint64_t budget_;
};

}  // namespace fluidcarve
