#include "carve/lattice/overlap.h"

#include "carve/field/extent.h"
#include "carve/lattice/block_places.h"

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <vector>

namespace fluidcarve {

using openvdb::BBoxd;
using openvdb::Coord;
using openvdb::Vec3d;

namespace {

/// The corners of a slab's cells, rims included, and the box around them. It encloses all points
/// that the cells hold.
struct Hull {
    std::array<Vec3d, 8> corners;
    BBoxd box;

    Hull(const Slabs& slabs, int k) {
        const auto rims = slabs.across();
        for (std::size_t n = 0; n < 8; ++n) {
            corners[n] = slabs[k].position((n & 1 ? rims.max() : rims.min()).x(),
                                           (n & 2 ? rims.max() : rims.min()).y(),
                                           n & 4 ? slabs.to(k) : slabs.from(k));
            box.expand(corners[n]);
        }
    }
    bool above(const Slabs::Divider& divider) const {
        return std::ranges::all_of(corners,
                                   [&](const Vec3d& corner) { return divider.side(corner) >= 0; });
    }
    bool below(const Slabs::Divider& divider) const {
        return std::ranges::all_of(corners,
                                   [&](const Vec3d& corner) { return divider.side(corner) < 0; });
    }
};

/// World box around all points that several slabs may hold. It joins the boxes of all pairs of
/// slabs that no plane separates. A slab's points lie above its lower divider and below its upper
/// one.
BBoxd meeting_box(const Slabs& slabs) {
    std::vector<Hull> hulls;
    for (int k = 0; k < slabs.size(); ++k) hulls.emplace_back(slabs, k);
    const auto same = [](const Slabs::Divider& a, const Slabs::Divider& b) {
        return a.normal == b.normal && a.point == b.point;
    };
    const bool ring = same(slabs.divider(0), slabs.divider(slabs.size()));
    return tbb::parallel_reduce(
        tbb::blocked_range<int>(0, slabs.size()), BBoxd(),
        [&](const tbb::blocked_range<int>& range, BBoxd out) {
            for (int a = range.begin(); a < range.end(); ++a)
                // Neighbours share a divider.
                for (int b = a + 2; b < slabs.size() - (ring && a == 0 ? 1 : 0); ++b) {
                    const auto &low = hulls[static_cast<std::size_t>(a)],
                               &high = hulls[static_cast<std::size_t>(b)];
                    if (!low.box.hasOverlap(high.box) || high.above(slabs.divider(a + 1)) ||
                        low.below(slabs.divider(b)) || high.below(slabs.divider(a)) ||
                        low.above(slabs.divider(b + 1)))
                        continue;
                    out.expand(BBoxd(openvdb::math::maxComponent(low.box.min(), high.box.min()),
                                     openvdb::math::minComponent(low.box.max(), high.box.max())));
                }
            return out;
        },
        [](BBoxd a, const BBoxd& b) {
            a.expand(b);
            return a;
        });
}

}  // namespace

Overlap count_overlap(const Mapping& mapping, const openvdb::math::Transform& transform) {
    if (!mapping.slabs()) return {};
    const int slabs = mapping.slabs()->size();
    const auto meeting = meeting_box(*mapping.slabs());
    if (meeting == BBoxd()) return {};
    const auto box = voxels_around(meeting, transform, "the lattice");
    require_walkable("the space where cells of the lattice meet", box, 2);
    const Coord low(box.min().x() >> 3, box.min().y() >> 3, box.min().z() >> 3);
    const Coord high((box.max().x() >> 3) + 1, (box.max().y() >> 3) + 1, (box.max().z() >> 3) + 1);
    const BlockPlaces prototype(mapping, transform);

    using Counts = std::vector<std::size_t>;  // `[slab]`
    const auto counts = tbb::parallel_reduce(
        tbb::blocked_range2d<int>(low.x(), high.x(), low.y(), high.y()),
        Counts(static_cast<std::size_t>(slabs)),
        [&](const tbb::blocked_range2d<int>& range, Counts counts) {
            auto places = prototype;
            std::array<int, 8> lowest{};
            for (int x = range.rows().begin(); x < range.rows().end(); ++x)
                for (int y = range.cols().begin(); y < range.cols().end(); ++y)
                    for (int z = low.z(); z < high.z(); ++z) {
                        const Coord block(8 * x, 8 * y, 8 * z);
                        places.move_to(block);
                        for (int row = 0; row < 64; ++row)
                            for (auto shared = places.locate_shared(
                                     block.offsetBy(row >> 3, row & 7, 0), lowest);
                                 shared != 0; shared &= shared - 1)
                                ++counts[static_cast<std::size_t>(
                                    lowest[static_cast<std::size_t>(std::countr_zero(shared))])];
                    }
            return counts;
        },
        [](Counts a, const Counts& b) {
            for (std::size_t k = 0; k < a.size(); ++k) a[k] += b[k];
            return a;
        });
    return {std::accumulate(counts.begin(), counts.end(), std::size_t{0}),
            static_cast<int>(std::ranges::max_element(counts) - counts.begin())};
}

}  // namespace fluidcarve
