#pragma once

#include <cstdint>

namespace fluidcarve {

/// Hashes a number to 64 well-mixed bits (Steele, Lea and Flood 2014).
constexpr std::uint64_t mixed_bits(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

/// A number in [0, 1), evenly distributed over identities.
constexpr double unit_hash(std::uint64_t identity) {
    return static_cast<double>(mixed_bits(identity) >> 11) * 0x1p-53;
}

}  // namespace fluidcarve
