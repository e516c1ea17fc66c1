#include "carve/points/points.h"

#include "carve/points/point_grid.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <string_view>
#include <utility>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {

bool is_whole(NumberType type) {
    return type != NumberType::float32 && type != NumberType::float64;
}

}  // namespace

std::size_t Points::size() const { return grid ? point_count(*grid) : ply->size; }

std::uint64_t Points::bytes() const { return grid ? grid->memUsage() : ply->bytes(); }

std::vector<Vec3d> Points::positions() const {
    if (grid) return point_positions(*grid);
    std::vector<Vec3d> out(ply->size, placement.translate);
    for (int axis = 0; axis < 3; ++axis) {
        const auto& column = *ply->column(std::string_view(&"xyz"[axis], 1));
        for (std::size_t n = 0; n < out.size(); ++n)
            out[n][axis] += placement.scale * PointTable::number(column, n);
    }
    return out;
}

std::vector<std::uint64_t> Points::identities() const {
    if (grid) return point_identities(*grid);
    std::vector<std::uint64_t> out(ply->size);
    const auto* const ids = ply->column("id");
    for (std::size_t n = 0; n < out.size(); ++n) {
        const auto at = ply->position(n);
        if (ids && is_whole(ids->type))
            out[n] =
                static_cast<std::uint64_t>(static_cast<std::int64_t>(PointTable::number(*ids, n)));
        else
            for (int c = 0; c < 3; ++c)
                out[n] = out[n] * 0x100000001b3u + std::bit_cast<std::uint64_t>(at[c]);
    }
    return out;
}

bool Points::has_ids() const {
    if (grid) return has_point_ids(*grid);
    const auto* const ids = ply->column("id");
    return ids && is_whole(ids->type);
}

bool alike(const Points& a, const Points& b) {
    if (a.grid) return b.grid && alike(*a.grid, *b.grid);
    return b.ply && std::ranges::equal(a.ply->columns, b.ply->columns, [](auto& x, auto& y) {
               return x.name == y.name && x.type == y.type;
           });
}

Points with_images(const Points& source, const std::vector<PointImage>& images,
                   const Points* more) {
    auto out = source;
    if (source.grid) {
        out.grid = with_images(*source.grid, images, more ? more->grid.get() : nullptr);
        return out;
    }
    const auto count = source.ply->size;
    auto ply = std::make_shared<PointTable>(*source.ply);
    ply->size = images.size();
    for (std::size_t c = 0; c < ply->columns.size(); ++c) {
        const auto size = static_cast<std::ptrdiff_t>(bytes_of(ply->columns[c].type));
        auto& to = ply->columns[c].values;
        to.clear();
        for (const auto& image : images) {
            const bool first = image.source < count;
            const auto& from = (first ? source : *more).ply->columns[c].values;
            const auto begin = from.begin() + size * static_cast<std::ptrdiff_t>(
                                                         image.source - (first ? 0 : count));
            to.insert(to.end(), begin, begin + size);
        }
    }
    for (std::size_t n = 0; n < images.size(); ++n)
        if (images[n].moved)
            ply->set_position(
                n, (images[n].position - source.placement.translate) / source.placement.scale);
    out.ply = std::move(ply);
    return out;
}

openvdb::GridBase::ConstPtr in_grid(const Points& points) {
    return points.grid ? points.grid : placed(grid_of(*points.ply), points.placement);
}

}  // namespace fluidcarve
