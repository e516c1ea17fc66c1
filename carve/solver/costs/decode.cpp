#include "carve/solver/costs/decode.h"

#include "carve/simd/wide.h"

#include <bit>
#include <cstddef>

namespace fluidcarve {

// Small codes are converted as integers: as bits of a float they would be denormal, which is slow.

FLUIDCARVE_WIDE void decode_energies(std::span<const std::uint16_t> codes, std::span<float> out) {
    for (std::size_t n = 0; n < codes.size(); ++n) {
        const std::uint32_t code = codes[n], is_small = code < 1024 ? ~0u : 0u;
        const auto small = std::bit_cast<std::uint32_t>(
            static_cast<float>(static_cast<std::int32_t>(code)) * 0x1p-41f);
        out[n] =
            std::bit_cast<float>((small & is_small) | ((code + (95u << 10)) << 13 & ~is_small));
    }
}

FLUIDCARVE_WIDE void decode_fields(std::span<const std::uint16_t> codes, std::span<float> out) {
    for (std::size_t n = 0; n < codes.size(); ++n) {
        const std::uint32_t code = codes[n], size = code & 0x7FFFu,
                            is_small = size < 1024 ? ~0u : 0u;
        const auto small = std::bit_cast<std::uint32_t>(
            static_cast<float>(static_cast<std::int32_t>(size)) * 0x1p-24f);
        out[n] =
            std::bit_cast<float>((small & is_small) | ((size + (112u << 10)) << 13 & ~is_small) |
                                 (code & 0x8000u) << 16);
    }
}

}  // namespace fluidcarve
