#pragma once

#include <openvdb/Types.h>
#include <openvdb/math/Coord.h>

#include <algorithm>
#include <cstring>

namespace fluidcarve {

/// Whether two values are the same bit for bit.
template <class T>
bool same_bits(const T& a, const T& b) {
    return std::memcmp(&a, &b, sizeof(T)) == 0;
}

/// Coord::floor, without a library call per component. Clamps positions beyond index space, or not
/// finite, to its ends.
inline openvdb::Coord voxel_below(const openvdb::Vec3d& q) {
    static constexpr double end = 2147483000;  // steps to neighbours still fit in 32 bits
    const auto floor = [](double at) {
        const double x = std::max(-end, std::min(at, end));
        const int towards_0 = static_cast<int>(x);
        return towards_0 - (towards_0 > x ? 1 : 0);
    };
    return {floor(q.x()), floor(q.y()), floor(q.z())};
}

/// Whether the cell of 2 x 2 x 2 voxels with lowest voxel `low` lies in one leaf.
inline bool in_one_leaf(const openvdb::Coord& low) {
    return (low.x() & 7) != 7 && (low.y() & 7) != 7 && (low.z() & 7) != 7;
}

/// Reads the values of a cell that lies in one leaf, `out[x][y][z]`, in the order of
/// openvdb::tools::BoxSampler. Not for leaves of booleans or masks.
template <class Leaf, class Value>
void read_cell(const Leaf& leaf, const openvdb::Coord& low, Value (&out)[2][2][2]) {
    const auto* const at = leaf.buffer().data() + Leaf::coordToOffset(low);
    for (int x = 0; x < 2; ++x)
        for (int y = 0; y < 2; ++y)
            for (int z = 0; z < 2; ++z) out[x][y][z] = at[64 * x + 8 * y + z];
}

}  // namespace fluidcarve
