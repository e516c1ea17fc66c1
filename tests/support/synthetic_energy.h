#pragma once

#include "carve/solver/costs/code.h"
#include "carve/solver/costs/energy_volume.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

/// Energies of any size like those of simulations, the same for the same seed.
namespace fluidcarve::test {

enum class Synthetic {
    smoke,  ///< swirls of three sizes in an elliptic plume, dear around it
    noise,  ///< each entry on its own
};

class SyntheticEnergy {
public:
    SyntheticEnergy(Synthetic kind, unsigned seed) : kind_(kind), seed_(seed) {}

    EnergyVolume operator()(const std::array<int, 3>& shape, std::size_t frames,
                            bool closed = false) const {
        EnergyVolume out({shape, Axis::u, frames, closed});
        const auto width = static_cast<std::size_t>(shape[0]),
                   laterals = static_cast<std::size_t>(shape[1]),
                   slices = static_cast<std::size_t>(shape[2]);
        tbb::parallel_for(std::size_t{0}, frames * slices, [&](std::size_t row) {
            std::vector<float> energies(width);
            for (std::size_t lateral = 0; lateral < laterals; ++lateral) {
                const Place place{lateral, row % slices, row / slices};
                if (kind_ == Synthetic::smoke)
                    fill_smoke(energies, place, static_cast<float>(laterals));
                else
                    for (std::size_t i = 0; i < width; ++i)
                        energies[i] = 0.05f + random({i, place[0], place[1], place[2]}, 0);
                auto* const codes =
                    out.codes(place[2]).data() + (lateral + laterals * place[1]) * width;
                for (std::size_t i = 0; i < width; ++i) codes[i] = encode_energy(energies[i]);
            }
        });
        return out;
    }

private:
    using Place = std::array<std::size_t, 3>;

    /// 0 to 1.
    float random(const std::array<std::size_t, 4>& at, unsigned octave) const {
        auto bits = static_cast<std::uint32_t>(seed_ * 16 + octave) * 0x9E3779B9u;
        for (const auto n : at) {
            bits = (bits ^ static_cast<std::uint32_t>(n)) * 0x85EBCA6Bu;
            bits ^= bits >> 15;
        }
        return static_cast<float>(bits * 0xC2B2AE35u >> 8) * 0x1p-24f;
    }

    /// Adds noise that changes over `cell` entries, columns and frames.
    void add_octave(std::vector<float>& energies, const Place& place, std::size_t cell,
                    float height, unsigned octave) const {
        const auto knot = [&](std::size_t n) {
            float out = 0;
            for (unsigned corner = 0; corner < 8; ++corner) {
                std::array<std::size_t, 4> at{n, 0, 0, 0};
                float weight = 1;
                for (unsigned d = 0; d < 3; ++d) {
                    const bool far = corner >> d & 1;
                    const auto part =
                        static_cast<float>(place[d] % cell) / static_cast<float>(cell);
                    at[d + 1] = place[d] / cell + far;
                    weight *= far ? part : 1 - part;
                }
                if (weight > 0) out += weight * random(at, octave);
            }
            return out;
        };
        float before = 0, after = knot(0);
        for (std::size_t i = 0; i < energies.size(); ++i) {
            if (i % cell == 0) {
                before = after;
                after = knot(i / cell + 1);
            }
            energies[i] += height * (before + (after - before) * static_cast<float>(i % cell) /
                                                  static_cast<float>(cell));
        }
    }

    void fill_smoke(std::vector<float>& energies, const Place& place, float laterals) const {
        std::ranges::fill(energies, 0.0f);
        add_octave(energies, place, 16, 0.5f, 1);
        add_octave(energies, place, 8, 0.3f, 2);
        add_octave(energies, place, 4, 0.2f, 3);
        const auto width = static_cast<float>(energies.size());
        for (std::size_t i = 0; i < energies.size(); ++i) {
            const float x = (static_cast<float>(i) - width / 2) / (0.35f * width),
                        y = (static_cast<float>(place[0]) - laterals / 2) / (0.6f * laterals);
            const float away = x * x + y * y,
                        grain = 0.05f * random({i, place[0], place[1], place[2]}, 0);
            const float swirl = 1.6f * std::abs(energies[i] + grain - 0.5f);
            energies[i] = away < 1 ? 0.5f * swirl + 0.001f : 0.4f + 0.3f * std::min(away - 1, 1.0f);
        }
    }

    Synthetic kind_;
    unsigned seed_;
};

}  // namespace fluidcarve::test
