#pragma once

#include <openvdb/Types.h>

#include <vector>

/// Swirls without sources: the curl of smoothed random vectors, repeated in all directions. Root
/// mean square 1 along each axis.
class CurlNoise {
public:
    explicit CurlNoise(unsigned seed);

    /// @param at  in wavelengths
    openvdb::Vec3f operator()(const openvdb::Vec3f& at) const;

private:
    static constexpr int size = 64;  ///< cells along an axis until the swirls repeat
    static constexpr float cells_per_wavelength = 8;
    static std::size_t place(int x, int y, int z) {
        constexpr int mask = size - 1;
        return static_cast<std::size_t>(((x & mask) * size + (y & mask)) * size + (z & mask));
    }
    std::vector<openvdb::Vec3f> swirls_;
};
