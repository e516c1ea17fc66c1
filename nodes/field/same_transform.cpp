#include "nodes/field/same_transform.h"

#include "graph/text/problem.h"

#include <fmt/format.h>

#include <cmath>

namespace fluidcarve {

bool cubes_along_axes(const openvdb::math::Transform& transform) {
    if (!transform.isLinear()) return false;
    const auto matrix = transform.baseMap()->getAffineMap()->getMat4();
    const double size = matrix(0, 0);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            if (!(size > 0) || std::abs(matrix(row, column) - (row == column ? size : 0)) > 1e-6 * size) return false;
    return true;
}

std::string place_text(const openvdb::math::Transform& transform) {
    const auto size = transform.voxelSize();
    const auto origin = transform.indexToWorld(openvdb::Vec3d(0));
    return fmt::format("voxels of {:.6g} x {:.6g} x {:.6g}, the first at [{:.6g}, {:.6g}, {:.6g}]", size.x(), size.y(), size.z(), origin.x(), origin.y(),
                       origin.z());
}

void require_same_transform(const std::string& what, const openvdb::GridBase& first, const openvdb::GridBase& second) {
    if (first.transform() == second.transform()) return;
    throw Failure(fmt::format("{} have different transforms: '{}' ({}) and '{}' ({}); resample one onto the other", what, first.getName(),
                              place_text(first.transform()), second.getName(), place_text(second.transform())));
}

void OneTransform::require(const std::string& what, const openvdb::math::Transform& transform, int frame) {
    if (!transform_) {
        transform_ = transform.copy();
        frame_ = frame;
    } else if (*transform_ != transform) {
        throw Failure(fmt::format("{} has {} in frame {}, but {} in frame {}: no lattice fits both; bake the sequence with a fixed domain, or resample it",
                                  what, place_text(*transform_), frame_, place_text(transform), frame));
    }
}

}  // namespace fluidcarve
