#include "carve/field/same_transform.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fluidcarve {

namespace {

using openvdb::Mat3d;

constexpr double hardly = 1e-6;  ///< relative difference allowed between voxel sizes, which may
                                 ///< have been stored as floats

/// Row i is the edge of a voxel along index axis i, world units.
Mat3d voxel_edges(const openvdb::math::Transform& transform) {
    return transform.baseMap()->getAffineMap()->getMat4().getMat3();
}

bool is_multiple_of_identity(const Mat3d& matrix, double size) {
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            if (!(std::abs(matrix(row, column) - (row == column ? size : 0)) <= hardly * size))
                return false;
    return true;
}

}  // namespace

bool cubes_along_axes(const openvdb::math::Transform& transform) {
    if (!transform.isLinear()) return false;
    const auto edges = voxel_edges(transform);
    return edges(0, 0) > 0 && is_multiple_of_identity(edges, edges(0, 0));
}

bool are_cubes(const openvdb::math::Transform& transform) {
    if (!transform.isLinear()) return false;
    const auto edges = voxel_edges(transform);
    const auto products = edges * edges.transpose();
    return is_multiple_of_identity(products, products(0, 0));
}

bool same_voxels(const openvdb::math::Transform& a, const openvdb::math::Transform& b) {
    if (!a.isLinear() || !b.isLinear()) return a == b;
    const auto edges_a = voxel_edges(a), edges_b = voxel_edges(b);
    double size = 0, apart = 0;
    for (int row = 0; row < 3; ++row) {
        size = std::max(size, edges_a.row(row).length());
        apart = std::max(apart, (edges_a.row(row) - edges_b.row(row)).length());
    }
    return apart <= hardly * size;
}

std::string place_text(const openvdb::math::Transform& transform) {
    const auto size = transform.voxelSize();
    const auto origin = transform.indexToWorld(openvdb::Vec3d(0));
    return fmt::format("voxels of {:.6g} x {:.6g} x {:.6g}, the first at [{}]", size.x(), size.y(),
                       size.z(), numbers_text(origin));
}

void require_same_transform(const std::string& what, const openvdb::GridBase& first,
                            const openvdb::GridBase& second) {
    if (first.transform() == second.transform()) return;
    throw Failure(fmt::format(
        "{} have different transforms: '{}' ({}) and '{}' ({}); resample one onto the other", what,
        first.getName(), place_text(first.transform()), second.getName(),
        place_text(second.transform())));
}

void SameVoxels::require(const std::string& what, const openvdb::math::Transform& transform,
                         int frame) {
    if (!transform_) {
        transform_ = transform.copy();
        frame_ = frame;
    } else if (!same_voxels(*transform_, transform)) {
        throw Failure(
            fmt::format("{} has {} in frame {}, but {} in frame {}: no lattice fits both; bake the "
                        "sequence with a fixed domain, or make its voxels alike with grid.resample",
                        what, place_text(*transform_), frame_, place_text(transform), frame));
    }
}

}  // namespace fluidcarve
