#include "nodes/lattice/overlap.h"

#include "nodes/lattice/block_places.h"

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>
#include <numeric>

namespace fluidcarve {

using openvdb::BBoxd;
using openvdb::Coord;
using openvdb::Vec3d;

Overlap count_overlap(const Mapping& mapping, const openvdb::math::Transform& transform) {
    if (!mapping.slabs()) return {};
    const int slabs = mapping.slabs()->size();
    const auto& extent = mapping.extent();
    const auto box = transform.worldToIndex(mapping.world_box(BBoxd(Vec3d(0), Vec3d(extent[0] - 1, extent[1] - 1, slabs))));
    const auto low = Coord::floor(box.min() / 8.0), high = Coord::ceil((box.max() + Vec3d(1)) / 8.0);
    const BlockPlaces prototype(mapping, transform);

    using Counts = std::vector<std::size_t>;  // per slab
    const auto counts = tbb::parallel_reduce(
        tbb::blocked_range2d<int>(low.x(), high.x(), low.y(), high.y()), Counts(static_cast<std::size_t>(slabs)),
        [&](const tbb::blocked_range2d<int>& range, Counts counts) {
            auto places = prototype;
            std::array<int, 8> lowest{};
            for (int x = range.rows().begin(); x < range.rows().end(); ++x)
                for (int y = range.cols().begin(); y < range.cols().end(); ++y)
                    for (int z = low.z(); z < high.z(); ++z) {
                        const Coord block(8 * x, 8 * y, 8 * z);
                        places.move_to(block);
                        for (int row = 0; row < 64; ++row)
                            for (auto shared = places.locate_shared(block.offsetBy(row >> 3, row & 7, 0), lowest); shared != 0; shared &= shared - 1)
                                ++counts[static_cast<std::size_t>(lowest[static_cast<std::size_t>(std::countr_zero(shared))])];
                    }
            return counts;
        },
        [](Counts a, const Counts& b) {
            for (std::size_t k = 0; k < a.size(); ++k) a[k] += b[k];
            return a;
        });
    return {std::accumulate(counts.begin(), counts.end(), std::size_t{0}), static_cast<int>(std::max_element(counts.begin(), counts.end()) - counts.begin())};
}

}  // namespace fluidcarve
