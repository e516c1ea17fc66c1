#pragma once

#include <openvdb/Types.h>
#include <openvdb/math/Coord.h>

#include <array>
#include <cstddef>

namespace fluidcarve {

/// Catmull-Rom weights of the values at -1, 0, 1 and 2, for a position `t` in [0, 1). They sum to 1
/// and reproduce linear functions.
inline std::array<double, 4> cubic_weights(double t) {
    return {((-0.5 * t + 1) * t - 0.5) * t, (1.5 * t - 2.5) * t * t + 1,
            ((-1.5 * t + 2) * t + 0.5) * t, (0.5 * t - 0.5) * t * t};
}

/// Samples a grid between its voxels, from a cube of 4^3 voxels.
/// @param q  index coordinates
template <class Value, class Accessor>
Value sample_cubic(const Accessor& values, const openvdb::Vec3d& q) {
    const auto low = openvdb::Coord::floor(q);
    const auto x = cubic_weights(q.x() - low.x()), y = cubic_weights(q.y() - low.y()),
               z = cubic_weights(q.z() - low.z());
    Value sum = openvdb::zeroVal<Value>();
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
            for (int k = 0; k < 4; ++k) {
                const double weight = x[static_cast<std::size_t>(i)] *
                                      y[static_cast<std::size_t>(j)] *
                                      z[static_cast<std::size_t>(k)];
                if (weight != 0)
                    sum += values.getValue(low.offsetBy(i - 1, j - 1, k - 1)) *
                           static_cast<typename openvdb::VecTraits<Value>::ElementType>(weight);
            }
    return sum;
}

}  // namespace fluidcarve
