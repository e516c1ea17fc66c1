#pragma once

#include "nodes/preview/view.h"

#include <openvdb/openvdb.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace fluidcarve {

/// The number shown for a value: itself, or the length of a vector.
inline float seen_value(float value) { return value; }
inline float seen_value(const openvdb::Vec3s& value) { return value.length(); }

/// Calls `body(leaf)` for all leaves that overlap an index box, in parallel. Leaves that share
/// cells are handled one after the other, so that the body may write to a Projection.
/// @param cell  size of a cell, voxels
template <class Tree, class Body>
void for_each_leaf_in_sight(const Tree& tree, View view, const openvdb::CoordBBox& box, int cell,
                            const Body& body) {
    using Leaf = typename Tree::LeafNodeType;
    const int block = std::max<int>(Leaf::DIM, cell);
    std::map<std::pair<int, int>, std::vector<const Leaf*>> lines;
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
        const auto bounds = leaf->getNodeBoundingBox();
        const auto place = in_cells(face_of(bounds, view), block).first;
        if (box.hasOverlap(bounds)) lines[{place[0], place[1]}].push_back(&*leaf);
    }
    std::vector<const std::vector<const Leaf*>*> tasks;
    for (const auto& [place, leaves] : lines) tasks.push_back(&leaves);
    tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t n) {
        for (const auto* leaf : *tasks[n]) body(*leaf);
    });
}

}  // namespace fluidcarve
