#include "nodes/page/page_grid.h"

#include "carve/base/failure.h"
#include "carve/field/extent.h"
#include "carve/volume/grid_types.h"
#include "nodes/preview/lines_of_sight.h"

#include <fmt/format.h>
#include <openvdb/tools/Interpolation.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace fluidcarve {

using openvdb::Coord;
using openvdb::Vec3d;

namespace {

float finite(float value) { return std::isfinite(value) ? value : 0; }

/// The results of `make()(place)` for all voxels of a page. `make` is called for each plane.
template <class Make>
auto each_voxel(const PageGrid& page, const Make& make) {
    std::vector<decltype(make()(Coord()))> out(page.count());
    tbb::parallel_for(0, page.size[2], [&](int z) {
        auto value = make();
        auto* to = out.data() + static_cast<std::ptrdiff_t>(z) * page.size[1] * page.size[0];
        for (int y = 0; y < page.size[1]; ++y)
            for (int x = 0; x < page.size[0]; ++x) *to++ = value(Coord(x, y, z));
    });
    return out;
}

/// Means of a grid over the cubes of a page, from its leaves and tiles: time grows with the
/// content, not with its extent.
template <class GridT>
class CubeMeans {
public:
    CubeMeans(const GridT& grid, const PageGrid& page)
        : page_(page), background_(finite(seen_value(grid.background()))) {
        planes_.resize(static_cast<std::size_t>(page.size[2]));
        for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf)
            add({leaf->getNodeBoundingBox(), &*leaf, 0});
        auto tile = grid.tree().cbeginValueAll();
        tile.setMaxDepth(decltype(tile)::LEAF_DEPTH - 1);
        for (; tile; ++tile)
            if (const auto value = finite(seen_value(*tile)); value != background_)
                add({tile.getBoundingBox(), nullptr, value});
    }

    /// As page_values().
    std::vector<float> values() const {
        std::vector<float> out(page_.count());
        const auto cells =
            static_cast<std::size_t>(page_.size[0]) * static_cast<std::size_t>(page_.size[1]);
        tbb::parallel_for(std::size_t{0}, planes_.size(), [&](std::size_t z) {
            std::vector<Sum> sums(cells);
            for (const auto part : planes_[z]) add(parts_[part], static_cast<int>(z), sums);
            const auto voxels = std::pow(static_cast<double>(page_.step), 3);
            for (std::size_t n = 0; n < cells; ++n)
                out[z * cells + n] = static_cast<float>(
                    (sums[n].of + (voxels - sums[n].voxels) * background_) / voxels);
        });
        return out;
    }

private:
    using Leaf = typename GridT::TreeType::LeafNodeType;
    /// A leaf, or a tile that is not the background.
    struct Part {
        openvdb::CoordBBox box;
        const Leaf* leaf;
        float value;
    };
    struct Sum {
        double of = 0, voxels = 0;
    };

    /// The voxels of a page voxel along an axis.
    std::pair<int, int> voxels_of(int cell, int axis) const {
        const int low = page_.first[axis] + cell * page_.step;
        return {low, low + page_.step - 1};
    }
    /// The page voxels that overlap a box along an axis; none if the first is above the last.
    std::pair<int, int> cells_of(const openvdb::CoordBBox& box, int axis) const {
        const auto cell = [&](int at) {
            return std::floor((static_cast<double>(at) - page_.first[axis]) / page_.step);
        };
        const double last = page_.size[static_cast<std::size_t>(axis)] - 1;
        return {static_cast<int>(std::clamp(cell(box.min()[axis]), 0.0, last + 1)),
                static_cast<int>(std::clamp(cell(box.max()[axis]), -1.0, last))};
    }

    void add(const Part& part) {
        if (const auto x = cells_of(part.box, 0), y = cells_of(part.box, 1);
            x.first > x.second || y.first > y.second)
            return;
        const auto [low, high] = cells_of(part.box, 2);
        for (int z = low; z <= high; ++z)
            planes_[static_cast<std::size_t>(z)].push_back(parts_.size());
        parts_.push_back(part);
    }

    /// Adds the values of a part in a plane of page voxels.
    void add(const Part& part, int plane, std::vector<Sum>& sums) const {
        const auto [first_x, last_x] = cells_of(part.box, 0);
        const auto [first_y, last_y] = cells_of(part.box, 1);
        for (int y = first_y; y <= last_y; ++y)
            for (int x = first_x; x <= last_x; ++x) {
                const auto [x0, x1] = voxels_of(x, 0);
                const auto [y0, y1] = voxels_of(y, 1);
                const auto [z0, z1] = voxels_of(plane, 2);
                auto box = openvdb::CoordBBox(Coord(x0, y0, z0), Coord(x1, y1, z1));
                box.intersect(part.box);
                auto& sum =
                    sums[static_cast<std::size_t>(y) * static_cast<std::size_t>(page_.size[0]) +
                         static_cast<std::size_t>(x)];
                add(part, box, sum);
            }
    }
    /// Adds what a part has in a box.
    static void add(const Part& part, const openvdb::CoordBBox& box, Sum& sum) {
        const auto voxels = static_cast<double>(voxels_in(box));
        sum.voxels += voxels;
        if (!part.leaf) sum.of += voxels * part.value;
        else
            for (auto at = box.begin(); at; ++at)
                sum.of += finite(seen_value(part.leaf->getValue(*at)));
    }

    const PageGrid& page_;
    float background_;
    std::vector<Part> parts_;
    /// For each plane of page voxels, the parts in it.
    std::vector<std::vector<std::size_t>> planes_;
};

template <class GridT>
std::vector<float> values_of(const GridT& grid, const PageGrid& page) {
    if (grid.transform() == *page.space) return CubeMeans(grid, page).values();
    return each_voxel(page, [&] {
        return [&grid, &page, values = grid.getConstAccessor()](const Coord& at) {
            const auto place = grid.transform().worldToIndex(page.world(at.asVec3d()));
            return voxel_at(place)
                       ? finite(seen_value(openvdb::tools::BoxSampler::sample(values, place)))
                       : 0.0f;
        };
    });
}

template <class GridT>
std::vector<std::uint8_t> active_of(const GridT& mask, const PageGrid& page) {
    return each_voxel(page, [&] {
        return [&mask, &page, values = mask.getConstAccessor()](const Coord& at) {
            const auto voxel = voxel_at(mask.transform().worldToIndex(page.world(at.asVec3d())));
            return static_cast<std::uint8_t>(voxel && values.isValueOn(*voxel) ? 255 : 0);
        };
    });
}

}  // namespace

PageGrid page_grid(openvdb::math::Transform::ConstPtr space, const openvdb::CoordBBox& box,
                   int voxels) {
    PageGrid out{std::move(space), box.min(), 1, {}};
    const auto extents = extents_of(box);
    out.step =
        static_cast<int>((std::max({extents[0], extents[1], extents[2]}) + voxels - 1) / voxels);
    for (std::size_t n = 0; n < 3; ++n)
        out.size[n] = static_cast<int>((extents[n] + out.step - 1) / out.step);
    return out;
}

std::vector<float> page_values(const openvdb::GridBase& grid, const PageGrid& page) {
    if (grid.isType<FloatGrid>()) return values_of(static_cast<const FloatGrid&>(grid), page);
    if (grid.isType<VectorGrid>()) return values_of(static_cast<const VectorGrid&>(grid), page);
    throw Failure(fmt::format("grid '{}' holds {} values; a page shows grids of floats or vectors",
                              grid.getName(), grid.valueType()));
}

std::vector<std::uint8_t> page_mask(const openvdb::GridBase& mask, const PageGrid& page) {
#define FLUIDCARVE_TRY(GridT) \
    if (mask.isType<GridT>()) return active_of(static_cast<const GridT&>(mask), page);
    FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_TRY)
#undef FLUIDCARVE_TRY
    throw Failure(fmt::format("grid '{}' is of type {}, which is no mask for a page",
                              mask.getName(), mask.type()));
}

std::vector<std::uint8_t> page_bytes(std::span<const float> values, float from, float to) {
    std::vector<std::uint8_t> out;
    out.reserve(values.size());
    for (const auto value : values) {
        const float share = (value - from) / (to - from);
        out.push_back(
            static_cast<std::uint8_t>(std::lround(255 * (share > 0 ? std::min(share, 1.0f) : 0))));
    }
    return out;
}

}  // namespace fluidcarve
