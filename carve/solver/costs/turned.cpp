#include "carve/solver/costs/turned.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace fluidcarve {

namespace {

constexpr std::size_t block_bytes = std::size_t{64} << 20;  ///< at least

/// Exchanges time and u of one list of codes per frame, some layers at once. All frames are read
/// for each block of layers.
/// @param budget  bytes that may be held
/// @param read    gives a frame's codes
/// @param write   takes a layer's codes
template <class Read, class Write>
void turn(const EnergyVolume& from, std::uint64_t budget, const Read& read, const Write& write) {
    const std::size_t columns = from.columns_per_frame(), frames = from.frames(),
                      layers = static_cast<std::size_t>(from.width()), stride = from.stride(),
                      layer = columns * frames,
                      block = std::clamp<std::size_t>(
                          std::max<std::size_t>(block_bytes, budget) / (2 * layer), 1, layers);
    std::vector<std::uint16_t> codes;
    for (std::size_t first = 0; first < layers; first += block) {
        const auto count = std::min(block, layers - first);
        codes.resize(count * layer);
        for (std::size_t t = 0; t < frames; ++t) {
            const auto& frame = read(t);
            tbb::parallel_for(std::size_t{0}, count, [&](std::size_t n) {
                auto* const out = codes.data() + n * layer + t;
                for (std::size_t c = 0; c < columns; ++c)
                    out[c * frames] = frame[c * stride + first + n];
            });
        }
        for (std::size_t n = 0; n < count; ++n)
            write(first + n, std::span<const std::uint16_t>(codes.data() + n * layer, layer));
    }
}

}  // namespace

EnergyVolume turned(const EnergyVolume& from, const Limits& limits) {
    auto shape = from.shape();
    shape.lattice[0] = static_cast<int>(from.frames());
    shape.frames = static_cast<std::size_t>(from.width());
    EnergyVolume out(shape, limits);
    turn(
        from, limits.memory / 4, [&](std::size_t t) { return from.codes(t); },
        [&](std::size_t layer, std::span<const std::uint16_t> codes) {
            std::ranges::copy(codes, out.codes(layer).begin());
        });
    if (!from.has_field()) return out;
    turn(
        from, limits.memory / 4, [&](std::size_t t) { return from.field_codes(t); },
        [&](std::size_t layer, std::span<const std::uint16_t> codes) {
            out.set_field(layer, codes);
        });
    return out;
}

}  // namespace fluidcarve
