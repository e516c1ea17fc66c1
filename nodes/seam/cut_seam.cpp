#include "nodes/seam/cut_seam.h"

#include "nodes/seam/energy_code.h"

#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

namespace fluidcarve {

namespace {

bool feasible(const Columns& columns, std::span<const std::uint16_t> seam) {
    for (std::size_t c = 0; c < seam.size(); ++c)
        for (const auto other : columns.around(c, columns.place(c)))
            if (other != Columns::none && std::abs(seam[c] - seam[other]) > 1) return false;
    return true;
}

/// @param energy_at  (column, entry)
template <class EnergyAt>
CutSeam solve(const Columns& columns, const Band& band, const EnergyAt& energy_at, double tolerance, int number, const std::function<void()>& tick) {
    const auto highest = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, columns.count(), 4096), 0.0f,
        [&](const tbb::blocked_range<std::size_t>& range, float most) {
            for (auto c = range.begin(); c < range.end(); ++c)
                for (int entry = band.columns[c].first; entry <= band.columns[c].last; ++entry) most = std::max(most, energy_at(c, entry));
            return most;
        },
        [](float a, float b) { return std::max(a, b); });
    // A power of two, so that what fits into 24 bits is not rounded.
    int exponent = 0;
    std::frexp(highest, &exponent);
    for (int bits = 24;; bits -= 6) {
        const double scale = std::ldexp(1.0, bits - exponent);
        const auto cost_of = [&](std::size_t c, Band::Column range, std::int32_t* costs) {
            for (int entry = range.first; entry <= range.last; ++entry) *costs++ = static_cast<std::int32_t>(scale * energy_at(c, entry));
        };
        Cut cut(columns, band, cost_of, number % 2 != 0);
        cut.solve(tolerance, tick);
        CutSeam out{cut.seam(), static_cast<double>(cut.flow()) / scale};
        // Where more flow gathered than an arc holds, neighbours may be torn apart; lower figures leave more room.
        if (feasible(columns, out.at)) return out;
    }
}

}  // namespace

namespace {

/// Calls back with a function that gives the energy at (column, entry).
template <class Call>
auto with_energies(const EnergyVolume& energy, const Call& call) {
    const auto in = [&](auto cell) {
        using Cell = decltype(cell);
        return call([&energy, per_frame = energy.columns_per_frame()](std::size_t c, int entry) {
            const auto value = energy.cells<Cell>(c / per_frame)[c % per_frame * energy.stride() + static_cast<std::size_t>(entry)];
            if constexpr (std::is_same_v<Cell, float>) return value;
            else return decode_energy(value);
        });
    };
    return energy.summed() ? in(float{}) : in(std::uint16_t{});
}

}  // namespace

CutSeam cut_seam(const EnergyVolume& energy, const Band& band, double tolerance, int number, const std::function<void()>& tick) {
    return with_energies(energy, [&](const auto& energy_at) { return solve(Columns(energy), band, energy_at, tolerance, number, tick); });
}

Seams::Seam exact_seam(const EnergyVolume& energy, Window window, int number, const std::function<void()>& tick) {
    auto cut = cut_seam(energy, Band::whole(Columns(energy).count(), window), 0, number, tick);
    const auto sum = energy_of(energy, cut.at);
    return {std::move(cut.at), sum, cut.lower_bound};
}

Seams::Seam keyframed_seam(const EnergyVolume& energy, Window window, int number, int interval, double threshold, const std::function<void()>& tick) {
    const Columns all(energy);
    std::vector<std::uint16_t> at;
    for (std::size_t begin = 0; begin < all.frames(); begin += static_cast<std::size_t>(interval)) {
        const auto frames = std::min(static_cast<std::size_t>(interval), all.frames() - begin);
        const Columns columns(static_cast<int>(all.laterals()), static_cast<int>(all.slices()), static_cast<int>(frames), all.closed());
        auto band = Band::whole(columns.count(), window);
        // A frame may drift from the last frame of the interval before by one entry for each frame between.
        for (std::size_t c = 0; begin > 0 && c < columns.count(); ++c) {
            const int home = at[begin * all.per_frame() - all.per_frame() + c % all.per_frame()], reach = static_cast<int>(c / all.per_frame()) + 1;
            band.columns[c] = {static_cast<std::uint16_t>(std::max(home - reach, window.first)),
                               static_cast<std::uint16_t>(std::min(home + reach, window.last))};
        }
        const auto part = with_energies(energy, [&](const auto& energy_at) {
            const auto above_threshold = [&](std::size_t c, int entry) {
                const auto value = energy_at(begin * all.per_frame() + c, entry);
                return value < threshold ? 0.0f : value;
            };
            return solve(columns, band, above_threshold, 0, number, tick);
        });
        at.insert(at.end(), part.at.begin(), part.at.end());
    }
    const auto sum = energy_of(energy, at);
    return {std::move(at), sum};
}

CutSeam cut_seam(const Strip& strip, std::span<const std::uint16_t> seam, int radius, double tolerance, int number, const std::function<void()>& tick) {
    Band band;
    band.columns.reserve(seam.size());
    for (std::size_t c = 0; c < seam.size(); ++c)
        band.columns.push_back({static_cast<std::uint16_t>(std::max<int>(seam[c] - radius, strip[c].first)),
                                static_cast<std::uint16_t>(std::min<int>(seam[c] + radius, strip[c].last))});
    return solve(
        strip.columns(), band, [&](std::size_t c, int entry) { return strip.energy(c, entry); }, tolerance, number, tick);
}

}  // namespace fluidcarve
