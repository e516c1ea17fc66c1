#include "nodes/page/page_grid.h"

#include "graph/text/problem.h"
#include "nodes/field/extent.h"
#include "nodes/grid_types.h"
#include "nodes/preview/lines_of_sight.h"

#include <openvdb/tools/Interpolation.h>
#include <tbb/parallel_for.h>

#include <fmt/format.h>

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

template <class GridT>
std::vector<float> values_of(const GridT& grid, const PageGrid& page) {
    const bool same = grid.transform() == *page.space;
    return each_voxel(page, [&] {
        return [&grid, &page, same, values = grid.getConstAccessor()](const Coord& at) {
            if (!same) {
                const auto place = grid.transform().worldToIndex(page.world(at.asVec3d()));
                if (!voxel_at(place)) return 0.0f;
                return finite(seen_value(openvdb::tools::BoxSampler::sample(values, place)));
            }
            const auto low = page.first + Coord(at.x() * page.step, at.y() * page.step, at.z() * page.step);
            double sum = 0;
            for (int x = 0; x < page.step; ++x)
                for (int y = 0; y < page.step; ++y)
                    for (int z = 0; z < page.step; ++z) sum += finite(seen_value(values.getValue(low.offsetBy(x, y, z))));
            return static_cast<float>(sum / (static_cast<double>(page.step) * page.step * page.step));
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

PageGrid page_grid(openvdb::math::Transform::ConstPtr space, const openvdb::CoordBBox& box, int voxels) {
    PageGrid out{std::move(space), box.min(), 1, {}};
    const auto extents = extents_of(box);
    out.step = static_cast<int>((std::max({extents[0], extents[1], extents[2]}) + voxels - 1) / voxels);
    for (std::size_t n = 0; n < 3; ++n) out.size[n] = static_cast<int>((extents[n] + out.step - 1) / out.step);
    return out;
}

std::vector<float> page_values(const openvdb::GridBase& grid, const PageGrid& page) {
    if (grid.isType<FloatGrid>()) return values_of(static_cast<const FloatGrid&>(grid), page);
    if (grid.isType<VectorGrid>()) return values_of(static_cast<const VectorGrid&>(grid), page);
    throw Failure(fmt::format("grid '{}' holds {} values; a page shows grids of floats or vectors", grid.getName(), grid.valueType()));
}

std::vector<std::uint8_t> page_mask(const openvdb::GridBase& mask, const PageGrid& page) {
#define FLUIDCARVE_TRY(GridT) \
    if (mask.isType<GridT>()) return active_of(static_cast<const GridT&>(mask), page);
    FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_TRY)
#undef FLUIDCARVE_TRY
    throw Failure(fmt::format("grid '{}' is of type {}, which is no mask for a page", mask.getName(), mask.type()));
}

std::vector<std::uint8_t> page_bytes(std::span<const float> values, float from, float to) {
    std::vector<std::uint8_t> out;
    out.reserve(values.size());
    for (const auto value : values) out.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp((value - from) / (to - from), 0.0f, 1.0f))));
    return out;
}

}  // namespace fluidcarve
