#include "nodes/seam/search/open_line.h"

#include "nodes/seam/energy/decode.h"
#include "nodes/seam/search/strip.h"
#include "nodes/vectors/wide.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace fluidcarve {

namespace {

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

/// The same where steps cost something, as in StepCosts::lift().
/// @param field, field_before  of the column and of the one before it; also before the first entry and behind the last
FLUIDCARVE_WIDE void extend_by_steps(const float* __restrict energies, const double* __restrict before, const float* __restrict field,
                                     const float* __restrict field_before, float rigidity, float weight, std::size_t count, double* __restrict now) {
    const double* const left = before - 1;
    const double* const right = before + 1;
    const float* const field_left = field - 1;
    const float* const field_right = field + 1;
    for (std::size_t i = 0; i < count; ++i) {
        const double rise = left[i] + static_cast<double>(rigidity + weight * std::abs(field_left[i] - field_before[i]));
        const double fall = right[i] + static_cast<double>(rigidity + weight * std::abs(field_right[i] - field_before[i]));
        const double beside = rise < fall ? rise : fall;
        now[i] = static_cast<double>(energies[i]) + (beside < before[i] ? beside : before[i]);
    }
}

/// Reads the energies of a window's entries.
class Rows {
public:
    Rows(const EnergyVolume& energy, Window window) : energy_(energy), first_(static_cast<std::size_t>(window.first)) {}

    /// The energies of `count` entries of a column; valid until the next call. @param begin  the first, counted from the window's first
    const float* operator()(std::size_t column, std::size_t begin, std::size_t count) {
        const auto per_frame = energy_.columns_per_frame(), frame = column / per_frame, cell = column % per_frame * energy_.stride() + first_ + begin;
        if (energy_.summed()) return energy_.cells<float>(frame) + cell;
        const auto* const codes = energy_.cells<std::uint16_t>(frame) + cell;
        decoded_.resize(count);
        if (energy_.protects() || energy_.attracts()) std::transform(codes, codes + count, decoded_.begin(), energy_.costs());
        else decode_energies({codes, count}, decoded_);
        return decoded_.data();
    }

private:
    const EnergyVolume& energy_;
    std::size_t first_;
    std::vector<float> decoded_;
};

constexpr double endless = std::numeric_limits<double>::infinity();

/// Finds the cheapest ways to a part of the window's entries, a run of columns at a time. Ways reach one entry further with each column, so the part looks at
/// as many entries beyond its ends as a run has columns.
class Part {
public:
    static constexpr std::size_t run = 64;  ///< columns

    /// @param begin, end  entries, counted from the window's first
    Part(const EnergyVolume& energy, Window window, std::size_t begin, std::size_t end)
        : rows_(energy, window),
          steps_(energy.steps()),
          rigidity_(energy.rigidity()[energy.frames() > 1 ? 1 : 0]),
          weight_(energy.field_weight()),
          begin_(begin),
          end_(end),
          from_(begin > run ? begin - run : 0),
          count_(std::min(end + run, static_cast<std::size_t>(window.size())) - from_),
          first_field_(static_cast<std::size_t>(window.first) + from_),
          field_(count_ + 2),
          field_before_(count_ + 2),
          ways_(count_ + 2, endless),
          ways_before_(count_ + 2, endless) {}

    /// Extends ways by the columns of a run.
    /// @param before  costs of the ways to all entries of the column before
    /// @param now     becomes those of the last column, for the part's entries
    /// @param keep    called with each column, and the costs of the ways to the part's entries there
    template <class Keep>
    void extend_by(std::size_t first_column, std::size_t end_column, std::span<const double> before, std::span<double> now, const Keep& keep) {
        std::ranges::copy(before.subspan(from_, count_), ways_before_.begin() + 1);
        const auto own = [&](const std::vector<double>& ways) { return std::span(ways).subspan(1 + begin_ - from_, end_ - begin_); };
        for (auto c = first_column; c < end_column; ++c) {
            read_field(c);
            const auto* const energies = rows_(c, from_, count_);
            if (!steps_ || c == 0) extend(energies, ways_before_.data() + 1, count_, ways_.data() + 1);
            else extend_by_steps(energies, ways_before_.data() + 1, field_.data() + 1, field_before_.data() + 1, rigidity_, weight_, count_, ways_.data() + 1);
            keep(c, begin_, own(ways_));
            std::swap(ways_before_, ways_);
        }
        std::ranges::copy(own(ways_before_), now.begin() + static_cast<std::ptrdiff_t>(begin_));
    }

private:
    /// Takes the next column's field.
    void read_field(std::size_t column) {
        if (!steps_.has_field()) return;
        std::swap(field_, field_before_);
        decode_fields({steps_.field(column) + first_field_, count_}, std::span(field_).subspan(1, count_));
    }

    Rows rows_;
    StepCosts steps_;
    float rigidity_, weight_;
    std::size_t begin_, end_, from_, count_, first_field_;
    std::vector<float> field_, field_before_;  ///< of a column and of the one before, with an entry more at both ends
    std::vector<double> ways_, ways_before_;   ///< costs, with an infinity at both ends
};

/// Finds the cheapest way through a line of columns.
class OpenLine {
public:
    OpenLine(const EnergyVolume& energy, Window window)
        : rows_(energy, window),
          steps_(energy.steps()),
          in_time_(energy.frames() > 1),
          length_(energy.columns_per_frame() * energy.frames()),
          width_(static_cast<std::size_t>(window.size())),
          first_(window.first) {
        constexpr std::size_t least = 4 * Part::run;
        const auto count = std::clamp<std::size_t>(width_ / least, 1, static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()));
        for (std::size_t n = 0; n < count; ++n) parts_.emplace_back(energy, window, width_ * n / count, width_ * (n + 1) / count);
    }

    /// Finds the cheapest way through all columns.
    /// @param at  becomes its entries, counted from the window's first
    /// @return its cost
    double solve(int number, std::vector<std::uint16_t>& at) {
        std::vector<double> before(width_, 0.0), now(width_);
        kept_.resize(((length_ - 1) / apart + 1) * width_);
        const auto keep = [&](std::size_t column, std::size_t entry, std::span<const double> ways) {
            if (column % apart == 0) std::ranges::copy(ways, kept_.begin() + static_cast<std::ptrdiff_t>(column / apart * width_ + entry));
        };
        for (std::size_t c = 0; c < length_; c += Part::run) {
            const auto end = std::min(c + Part::run, length_);
            tbb::parallel_for(std::size_t{0}, parts_.size(), [&](std::size_t n) { parts_[n].extend_by(c, end, before, now, keep); });
            std::swap(before, now);
        }
        const auto least = std::ranges::min_element(before);
        at.resize(length_);
        at.back() = static_cast<std::uint16_t>(least - before.begin());
        for (auto last = length_ - 1; last > 0; last = (last - 1) / apart * apart) go_back(last, number, at);
        return *least;
    }

private:
    static constexpr std::size_t apart = 32;  ///< columns from one whose ways are kept to the next
    /// Costs of the ways to those entries of a column from which the seam can be reached, with infinities around.
    using Ways = std::array<double, 2 * apart + 3>;

    /// Cost of the step to an entry of a column from one of the column before; entries counted from the window's first.
    double step_cost(std::size_t column, std::ptrdiff_t entry, std::ptrdiff_t from) const {
        return steps_ ? static_cast<double>(steps_(column, first_ + static_cast<int>(entry), column - 1, first_ + static_cast<int>(from), in_time_)) : 0;
    }

    /// Cost of a way to the entry before that a step comes from, and of the step.
    /// @param to   costs of the ways to the column before
    /// @param n    of the entry, in `to`, which begins at entry `low`
    double way_from(const Ways& to, std::ptrdiff_t n, int step, std::size_t column, std::ptrdiff_t low) const {
        const double way = to[static_cast<std::size_t>(n + step)];
        return way < endless ? way + step_cost(column, low + n, low + n + step) : way;
    }

    /// Follows the seam from its entry in a column back to the nearest column before whose ways were kept.
    void go_back(std::size_t last, int number, std::vector<std::uint16_t>& at) {
        const auto first = (last - 1) / apart * apart;
        const auto reach = static_cast<std::ptrdiff_t>(last - first), low = static_cast<std::ptrdiff_t>(at[last]) - reach - 1;
        // Index n stands for entry low + n.
        for (std::size_t c = first; c < last; ++c) {
            auto& ways = ways_[c - first];
            ways.fill(endless);
            const auto begin = static_cast<std::size_t>(std::max<std::ptrdiff_t>(low, 0));
            const auto* const row = c == first ? nullptr : rows_(c, begin, std::min(width_, begin + ways.size()) - begin);
            const auto slack = static_cast<std::ptrdiff_t>(c - first) + 1;
            for (std::ptrdiff_t n = slack; n <= 2 * reach + 2 - slack; ++n) {
                const auto entry = low + n;
                if (entry < 0 || entry >= static_cast<std::ptrdiff_t>(width_)) continue;
                const auto place = static_cast<std::size_t>(n), e = static_cast<std::size_t>(entry);
                if (!row) {
                    ways[place] = kept_[first / apart * width_ + e];
                } else {
                    const auto& to = ways_[c - first - 1];
                    const auto from = [&](int step) { return way_from(to, n, step, c, low); };
                    ways[place] = static_cast<double>(row[e - begin]) + std::min({from(-1), from(0), from(1)});
                }
            }
        }
        const int side = number % 2 == 0 ? -1 : 1;
        auto n = reach + 1;
        for (auto c = last; c-- > first;) {
            const auto way = [&](int step) { return way_from(ways_[c - first], n, step, c + 1, low); };
            int best = 0;
            for (const int step : {side, -side})
                if (way(step) < way(best)) best = step;
            n += best;
            at[c] = static_cast<std::uint16_t>(low + n);
        }
    }

    Rows rows_;
    const StepCosts steps_;
    const bool in_time_;
    const std::size_t length_, width_;
    const int first_;
    std::vector<Part> parts_;
    std::vector<double> kept_;  ///< `[column / apart][entry]`
    std::array<Ways, apart> ways_;
};

}  // namespace

Seams::Seam open_line_seam(const EnergyVolume& energy, Window window, int number) {
    std::vector<std::uint16_t> at;
    const auto least = OpenLine(energy, window).solve(number, at);
    for (auto& entry : at) entry = static_cast<std::uint16_t>(entry + window.first);
    const auto sum = energy.attracts() ? energy_of(energy, at) : least;
    return {std::move(at), sum, sum};
}

}  // namespace fluidcarve
