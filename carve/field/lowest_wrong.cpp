#include "carve/field/lowest_wrong.h"

#include <openvdb/tree/LeafManager.h>

#include <cmath>
#include <cstddef>
#include <mutex>

namespace fluidcarve {

std::optional<WrongValue> lowest_wrong(const openvdb::FloatGrid& grid, float least) {
    using openvdb::FloatTree;
    std::mutex mutex;
    std::optional<WrongValue> out;
    const auto look = [&](auto value) {
        for (; value; ++value) {
            if (std::isfinite(*value) && *value >= least) continue;
            const std::lock_guard lock(mutex);
            if (!out || value.getCoord() < out->at) out = WrongValue{value.getCoord(), *value};
        }
    };
    openvdb::tree::LeafManager<const FloatTree>(grid.tree())
        .foreach (
            [&](const FloatTree::LeafNodeType& leaf, std::size_t) { look(leaf.cbeginValueOn()); });
    auto tiles = grid.cbeginValueOn();
    tiles.setMaxDepth(decltype(tiles)::LEAF_DEPTH - 1);
    look(tiles);
    return out;
}

}  // namespace fluidcarve
