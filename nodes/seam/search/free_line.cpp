#include "nodes/seam/search/free_line.h"

#include "nodes/seam/energy/wide.h"
#include "nodes/seam/search/strip.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

namespace fluidcarve {

namespace {

/// Decodes energy codes without marks: decode_energy() without a branch.
FLUIDCARVE_WIDE void decode(const std::uint16_t* __restrict codes, std::size_t count, float* __restrict energies) {
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t code = codes[i], is_small = code < 1024 ? ~0u : 0u;
        const auto small = std::bit_cast<std::uint32_t>(static_cast<float>(static_cast<std::int32_t>(code)) * 0x1p-41f);
        energies[i] = std::bit_cast<float>((small & is_small) | ((code + (95u << 10)) << 13 & ~is_small));
    }
}

/// Extends the cheapest ways to the entries of a column by the next column.
/// @param before  costs of these ways, with an infinity before the first entry and behind the last
FLUIDCARVE_WIDE void extend(const float* __restrict energies, const double* __restrict before, std::size_t count, double* __restrict now) {
    const double* const left = before - 1;
    const double* const right = before + 1;
    for (std::size_t i = 0; i < count; ++i) {
        const double beside = left[i] < right[i] ? left[i] : right[i];
        now[i] = static_cast<double>(energies[i]) + (beside < before[i] ? beside : before[i]);
    }
}

#undef FLUIDCARVE_WIDE

/// Reads the energies of a window's entries, column by column.
class Rows {
public:
    Rows(const EnergyVolume& energy, Window window)
        : energy_(energy), first_(static_cast<std::size_t>(window.first)), decoded_(static_cast<std::size_t>(window.size())) {}

    /// The energies of a column; valid until the next call.
    const float* operator()(std::size_t column) {
        const auto per_frame = energy_.columns_per_frame(), frame = column / per_frame, cell = column % per_frame * energy_.stride() + first_;
        if (energy_.summed()) return energy_.cells<float>(frame) + cell;
        const auto* const codes = energy_.cells<std::uint16_t>(frame) + cell;
        if (energy_.protects() || energy_.attracts()) std::transform(codes, codes + decoded_.size(), decoded_.begin(), energy_.costs());
        else decode(codes, decoded_.size(), decoded_.data());
        return decoded_.data();
    }

private:
    const EnergyVolume& energy_;
    std::size_t first_;
    std::vector<float> decoded_;
};

/// Finds the cheapest way through a line of columns.
class FreeLine {
public:
    FreeLine(const EnergyVolume& energy, Window window)
        : rows_(energy, window), length_(energy.columns_per_frame() * energy.frames()), width_(static_cast<std::size_t>(window.size())) {}

    /// Finds the cheapest way through all columns.
    /// @param at  becomes its entries, counted from the window's first
    /// @return its cost
    double solve(int number, std::vector<std::uint16_t>& at) {
        std::vector<double> before(width_ + 2, endless), now(width_ + 2, endless);
        std::fill(before.begin() + 1, before.end() - 1, 0.0);
        kept_.resize(((length_ - 1) / apart + 1) * width_);
        for (std::size_t c = 0; c < length_; ++c) {
            extend(rows_(c), before.data() + 1, width_, now.data() + 1);
            if (c % apart == 0) std::copy_n(now.begin() + 1, width_, kept_.begin() + static_cast<std::ptrdiff_t>(c / apart * width_));
            std::swap(before, now);
        }
        const auto least = std::min_element(before.begin() + 1, before.end() - 1);
        at.resize(length_);
        at.back() = static_cast<std::uint16_t>(least - before.begin() - 1);
        for (auto last = length_ - 1; last > 0; last = (last - 1) / apart * apart) go_back(last, number, at);
        return *least;
    }

private:
    static constexpr std::size_t apart = 32;  ///< columns from one whose ways are kept to the next
    static constexpr double endless = std::numeric_limits<double>::infinity();
    /// Costs of the ways to those entries of a column from which the seam can be reached, with infinities around.
    using Ways = std::array<double, 2 * apart + 3>;

    /// Follows the seam from its entry in a column back to the nearest column before whose ways were kept.
    void go_back(std::size_t last, int number, std::vector<std::uint16_t>& at) {
        const auto first = (last - 1) / apart * apart;
        const auto reach = static_cast<std::ptrdiff_t>(last - first), low = static_cast<std::ptrdiff_t>(at[last]) - reach - 1;
        // Index n stands for entry low + n.
        for (std::size_t c = first; c < last; ++c) {
            auto& ways = ways_[c - first];
            ways.fill(endless);
            const auto* const row = c == first ? nullptr : rows_(c);
            const auto slack = static_cast<std::ptrdiff_t>(c - first) + 1;
            for (std::ptrdiff_t n = slack; n <= 2 * reach + 2 - slack; ++n) {
                const auto entry = low + n;
                if (entry < 0 || entry >= static_cast<std::ptrdiff_t>(width_)) continue;
                const auto place = static_cast<std::size_t>(n), e = static_cast<std::size_t>(entry);
                if (!row) {
                    ways[place] = kept_[first / apart * width_ + e];
                } else {
                    const auto& to = ways_[c - first - 1];
                    ways[place] = static_cast<double>(row[e]) + std::min({to[place - 1], to[place], to[place + 1]});
                }
            }
        }
        const int side = number % 2 == 0 ? -1 : 1;
        auto n = reach + 1;
        for (auto c = last; c-- > first;) {
            const auto way = [&](int step) { return ways_[c - first][static_cast<std::size_t>(n + step)]; };
            int best = 0;
            for (const int step : {side, -side})
                if (way(step) < way(best)) best = step;
            n += best;
            at[c] = static_cast<std::uint16_t>(low + n);
        }
    }

    Rows rows_;
    std::size_t length_, width_;
    std::vector<double> kept_;  ///< `[column / apart][entry]`
    std::array<Ways, apart> ways_;
};

}  // namespace

Seams::Seam free_line_seam(const EnergyVolume& energy, Window window, int number) {
    std::vector<std::uint16_t> at;
    const auto least = FreeLine(energy, window).solve(number, at);
    for (auto& entry : at) entry = static_cast<std::uint16_t>(entry + window.first);
    const auto sum = energy.attracts() ? energy_of(energy, at) : least;
    return {std::move(at), sum, sum};
}

}  // namespace fluidcarve
