#include "carve/field/extent.h"

#include "carve/base/failure.h"
#include "carve/base/limits.h"
#include "carve/base/words.h"
#include "carve/field/same_transform.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <limits>

namespace fluidcarve {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

namespace {

/// Limits of a walk over blocks. A lattice of the most vertices, on voxels, has 2^26 lines.
constexpr std::uint64_t most_lines = std::uint64_t{1} << 27, most_blocks = std::uint64_t{1} << 35;

std::uint64_t product(std::uint64_t a, std::uint64_t b) {
    std::uint64_t out = 0;
    return __builtin_mul_overflow(a, b, &out) ? std::numeric_limits<std::uint64_t>::max() : out;
}

bool is_near(const Vec3d& at) {
    const auto near = [](double x) { return std::abs(x) <= farthest_voxel; };
    return near(at.x()) && near(at.y()) && near(at.z());
}

}  // namespace

std::array<std::int64_t, 3> extents_of(const CoordBBox& box) {
    if (box.empty()) return {};
    const auto along = [&](int axis) {
        return std::int64_t{box.max()[axis]} - box.min()[axis] + 1;
    };
    return {along(0), along(1), along(2)};
}

std::uint64_t voxels_in(const CoordBBox& box) {
    const auto [x, y, z] = extents_of(box);
    return product(product(static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)),
                   static_cast<std::uint64_t>(z));
}

std::string span_text(const CoordBBox& box) {
    const auto [x, y, z] = extents_of(box);
    return fmt::format("[{}] to [{}]: {} x {} x {} voxels", numbers_text(box.min()),
                       numbers_text(box.max()), x, y, z);
}

CoordBBox padded(const CoordBBox& box, int voxels) {
    using Limits = std::numeric_limits<std::int32_t>;
    auto out = box;
    for (int axis = 0; axis < 3; ++axis) {
        out.min()[axis] = static_cast<std::int32_t>(
            std::max<std::int64_t>(std::int64_t{box.min()[axis]} - voxels, Limits::min()));
        out.max()[axis] = static_cast<std::int32_t>(
            std::min<std::int64_t>(std::int64_t{box.max()[axis]} + voxels, Limits::max()));
    }
    return out;
}

std::optional<Coord> voxel_at(const Vec3d& at) {
    return is_near(at) ? std::optional(Coord::round(at)) : std::nullopt;
}

Vec3d near_place(const Vec3d& at) {
    const auto near = [](double x) {
        return std::isnan(x) ? 0 : std::clamp<double>(x, -farthest_voxel, farthest_voxel);
    };
    return {near(at.x()), near(at.y()), near(at.z())};
}

CoordBBox voxels_around(const openvdb::BBoxd& world, const openvdb::math::Transform& transform,
                        const std::string& what) {
    const auto box = transform.worldToIndex(world);
    if (!world.min().isFinite() || !world.max().isFinite() || !is_near(box.min()) ||
        !is_near(box.max()))
        throw Failure(
            fmt::format("{} reaches from [{}] to [{}], counted in {}; {} is the "
                        "farthest: check the units of both, or resample the grid",
                        what, numbers_text(box.min()), numbers_text(box.max()),
                        place_text(transform), farthest_voxel));
    return {Coord::floor(box.min()), Coord::ceil(box.max())};
}

void require_near(const std::string& grid, const CoordBBox& box, const std::string& remedy) {
    if (box.empty() || (is_near(box.min().asVec3d()) && is_near(box.max().asVec3d()))) return;
    throw Failure(
        fmt::format("the active voxels of grid '{}' span {}; voxel {} is the farthest: {}", grid,
                    span_text(box), farthest_voxel, remedy),
        Failure::Kind::input);
}

void require_walkable(const std::string& what, const CoordBBox& box, int axis) {
    if (box.empty()) return;
    std::array<std::uint64_t, 3> blocks{};
    for (int n = 0; n < 3; ++n)
        blocks[static_cast<std::size_t>(n)] =
            static_cast<std::uint64_t>((box.max()[n] >> 3) - std::int64_t{box.min()[n] >> 3} + 1);
    const auto along = static_cast<std::size_t>(axis);
    const auto lines = product(blocks[(along + 1) % 3], blocks[(along + 2) % 3]);
    if (lines > most_lines || product(lines, blocks[along]) > most_blocks)
        throw Failure(
            fmt::format("{} spans {}, more than can be walked: make it smaller, or crop the grid",
                        what, span_text(box)));
}

}  // namespace fluidcarve
