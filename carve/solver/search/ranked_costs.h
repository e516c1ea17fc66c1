#pragma once

#include "carve/solver/costs/code.h"
#include "carve/solver/costs/decode.h"
#include "carve/solver/costs/energy_volume.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <type_traits>

namespace fluidcarve {

/// Costs of entries if none is marked, and ranks that order as the costs do.
struct Unmarked {
    explicit Unmarked(const EnergyVolume&) {}
    static float cost(std::uint16_t code) { return decode_energy(code); }
    static float cost(float sum) { return sum; }
    static std::uint32_t rank(std::uint16_t code) { return code; }
    static std::uint32_t rank(float energy) { return std::bit_cast<std::uint32_t>(energy); }
    template <class Cell>
    static float cost_of_rank(std::uint32_t rank) {
        if constexpr (std::is_same_v<Cell, float>) return std::bit_cast<float>(rank);
        else return decode_energy(static_cast<std::uint16_t>(rank));
    }
};

/// The same if some are marked.
class Marked {
public:
    /// Cost of a protected entry: higher than any way around it, but finite, so that fewer of them
    /// cost less.
    static constexpr float blocked = 1e30f;

    explicit Marked(const EnergyVolume& energy) : costs_(energy.costs()) {}
    template <class Cell>
    float cost(Cell cell) const {
        return std::min(costs_(cell), blocked);
    }
    template <class Cell>
    std::uint32_t rank(Cell cell) const {
        const auto bits = std::bit_cast<std::uint32_t>(cost(cell));
        return bits ^ (bits >> 31 != 0 ? ~std::uint32_t{0} : sign);
    }
    template <class Cell>
    static float cost_of_rank(std::uint32_t rank) {
        return std::bit_cast<float>(rank ^ ((rank & sign) != 0 ? sign : ~std::uint32_t{0}));
    }

private:
    static constexpr std::uint32_t sign = 0x80000000;
    EntryCosts costs_;
};

}  // namespace fluidcarve
