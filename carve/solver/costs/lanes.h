#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

/// Four neighbouring entries at once: as many as a seam may choose from next, and one more.
namespace fluidcarve {

using Lanes = float __attribute__((vector_size(16)));
using LaneBits = std::uint32_t __attribute__((vector_size(16)));
/// All bits of a lane, or none.
using LaneMask = std::int32_t __attribute__((vector_size(16)));
constexpr int lane_count = 4;

/// Four codes, each in the lower half of a lane.
inline LaneBits load_codes(const std::uint16_t* codes) {
    std::uint16_t __attribute__((vector_size(8))) four;
    std::memcpy(&four, codes, sizeof four);
    return __builtin_convertvector(four, LaneBits);
}

// Small codes are converted as integers: as bits of a float they would be denormal, which is slow.

/// decode_energy() of four codes, at most highest_energy_code.
inline Lanes energy_lanes(const std::uint16_t* codes) {
    const auto bits = load_codes(codes);
    const auto small = std::bit_cast<LaneBits>(
        __builtin_convertvector(std::bit_cast<LaneMask>(bits), Lanes) * 0x1p-41f);
    const auto is_small = std::bit_cast<LaneBits>(std::bit_cast<LaneMask>(bits) < 1024);
    return std::bit_cast<Lanes>((small & is_small) | ((bits + (95u << 10)) << 13 & ~is_small));
}

/// decode_field() of four codes.
inline Lanes field_lanes(const std::uint16_t* codes) {
    const auto bits = load_codes(codes), size = bits & 0x7FFF;
    const auto small = std::bit_cast<LaneBits>(
        __builtin_convertvector(std::bit_cast<LaneMask>(size), Lanes) * 0x1p-24f);
    const auto is_small = std::bit_cast<LaneBits>(std::bit_cast<LaneMask>(size) < 1024);
    return std::bit_cast<Lanes>((small & is_small) | ((size + (112u << 10)) << 13 & ~is_small) |
                                (bits & 0x8000) << 16);
}

/// Four consecutive values.
inline Lanes load_values(const float* values) {
    Lanes out;
    std::memcpy(&out, values, sizeof out);
    return out;
}

inline void store_values(Lanes values, float* out) { std::memcpy(out, &values, sizeof values); }

/// A mask of the lanes whose entries lie in an interval.
/// @param base  the entry in the first lane
inline LaneMask lanes_within(int low, int high, int base) {
    constexpr LaneMask places{0, 1, 2, 3};
    return (places >= low - base) & (places <= high - base);
}

/// The lanes of a mask; the others become 0.
inline Lanes within(Lanes values, LaneMask mask) {
    return std::bit_cast<Lanes>(std::bit_cast<LaneMask>(values) & mask);
}

/// The lanes, with that of an entry set to 0.
inline Lanes without(Lanes values, int base, int entry) {
    constexpr LaneMask places{0, 1, 2, 3};
    return std::bit_cast<Lanes>(std::bit_cast<LaneMask>(values) & (places != entry - base));
}

inline Lanes absolute(Lanes values) {
    return std::bit_cast<Lanes>(std::bit_cast<LaneBits>(values) & 0x7FFFFFFF);
}

}  // namespace fluidcarve
