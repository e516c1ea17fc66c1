#include "carve/solver/search/open_line.h"

#include "carve/simd/wide.h"
#include "carve/solver/costs/decode.h"
#include "carve/solver/search/strip.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace fluidcarve {

namespace {

/// Extends the cheapest ways to the entries of a column by the next column.
/// @param before  costs of these ways, with an infinity before the first entry and behind the last
FLUIDCARVE_WIDE void extend(const float* __restrict energies, const double* __restrict before,
                            std::size_t count, double* __restrict now) {
    const double* const left = before - 1;
    const double* const right = before + 1;
    for (std::size_t i = 0; i < count; ++i) {
        const double beside = left[i] < right[i] ? left[i] : right[i];
        now[i] = static_cast<double>(energies[i]) + (beside < before[i] ? beside : before[i]);
    }
}

/// The same where steps cost something, as in StepCosts::lift().
/// @param field, field_before  of the column and of the one before it; also before the first entry
///   and behind the last
FLUIDCARVE_WIDE void extend_by_steps(const float* __restrict energies,
                                     const double* __restrict before, const float* __restrict field,
                                     const float* __restrict field_before, const StepPrice& price,
                                     std::size_t count, double* __restrict now) {
    const double* const left = before - 1;
    const double* const right = before + 1;
    const float* const field_left = field - 1;
    const float* const field_right = field + 1;
    for (std::size_t i = 0; i < count; ++i) {
        const double rise =
            left[i] + static_cast<double>(price.rigid(field_left[i], field_before[i]) +
                                          price.weight * std::abs(field_left[i] - field_before[i]));
        const double fall =
            right[i] +
            static_cast<double>(price.rigid(field_right[i], field_before[i]) +
                                price.weight * std::abs(field_right[i] - field_before[i]));
        const double beside = rise < fall ? rise : fall;
        now[i] = static_cast<double>(energies[i]) + (beside < before[i] ? beside : before[i]);
    }
}

constexpr double endless = std::numeric_limits<double>::infinity();

/// The line in which a seam is sought now.
struct Line {
    const EnergyVolume& energy;
    std::size_t first, width;  ///< of the window; entries below are counted from its first
    StepCosts steps;
    bool in_time;
    StepPrice price;
    std::size_t length;  ///< columns

    Line(const EnergyVolume& energy, Window window)
        : energy(energy),
          first(static_cast<std::size_t>(window.first)),
          width(static_cast<std::size_t>(window.size())),
          steps(energy.steps()),
          in_time(energy.frames() > 1),
          price(steps.price(in_time)),
          length(energy.columns_per_frame() * energy.frames()) {}

    /// The energies of `count` entries of a column. @param decoded  where they may be put
    const float* energies(std::size_t column, std::size_t begin, std::size_t count,
                          std::vector<float>& decoded) const {
        const auto per_frame = energy.columns_per_frame(), frame = column / per_frame,
                   cell = column % per_frame * energy.stride() + first + begin;
        if (energy.summed()) return energy.cells<float>(frame) + cell;
        const auto* const codes = energy.cells<std::uint16_t>(frame) + cell;
        decoded.resize(count);
        if (energy.protects() || energy.attracts())
            std::transform(codes, codes + count, decoded.begin(), energy.costs());
        else decode_energies({codes, count}, decoded);
        return decoded.data();
    }
    /// Cost of the step to an entry of a column from one of the column before.
    double step_cost(std::size_t column, std::ptrdiff_t entry, std::ptrdiff_t from) const {
        const auto place = [&](std::ptrdiff_t n) {
            return static_cast<int>(first) + static_cast<int>(n);
        };
        return steps ? static_cast<double>(
                           steps(column, place(entry), column - 1, place(from), in_time))
                     : 0;
    }
};

/// Entries `begin` to `end - 1`.
struct EntryRange {
    std::size_t begin = 0, end = 0;
    bool empty() const { return begin >= end; }
    std::size_t size() const { return end - begin; }
    void add(const EntryRange& other) {
        if (other.empty()) return;
        *this =
            empty() ? other : EntryRange{std::min(begin, other.begin), std::max(end, other.end)};
    }
    EntryRange widened(std::size_t by, std::size_t width) const {
        return {begin > by ? begin - by : 0, std::min(end + by, width)};
    }
};

/// Extends the cheapest ways to some entries by a few columns. Ways reach one entry further with
/// each column, so this looks at as many entries beyond both ends as there are columns.
class Extension {
public:
    /// @param column      the last one that the ways before reach
    /// @param before      costs of these ways, to all entries
    /// @param end_column  behind the last column
    /// @param now         becomes the costs of the ways to the last column, for the entries of
    ///   `range`
    void operator()(const Line& line, std::size_t column, std::span<const double> before,
                    std::size_t end_column, const EntryRange& range, double* now) {
        const auto all = range.widened(end_column - column - 1, line.width);
        const auto count = all.size();
        for (auto* const ways : {&ways_, &ways_before_}) {
            ways->resize(count + 2);
            ways->front() = ways->back() = endless;
        }
        std::ranges::copy(before.subspan(all.begin, count), ways_before_.begin() + 1);
        read_field(line, column, all);
        for (auto c = column + 1; c < end_column; ++c) {
            std::swap(field_, field_before_);
            read_field(line, c, all);
            const auto* const energies = line.energies(c, all.begin, count, decoded_);
            if (!line.steps) extend(energies, ways_before_.data() + 1, count, ways_.data() + 1);
            else
                extend_by_steps(energies, ways_before_.data() + 1, field_.data() + 1,
                                field_before_.data() + 1, line.price, count, ways_.data() + 1);
            std::swap(ways_before_, ways_);
        }
        std::copy_n(ways_before_.begin() + static_cast<std::ptrdiff_t>(1 + range.begin - all.begin),
                    range.size(), now);
    }

private:
    /// Reads a column's field, with an entry more at both ends.
    void read_field(const Line& line, std::size_t column, const EntryRange& all) {
        field_.resize(all.size() + 2);
        field_before_.resize(all.size() + 2);
        if (line.steps.has_field())
            line.steps.field(column)->read(static_cast<int>(line.first + all.begin),
                                           std::span(field_).subspan(1, all.size()));
    }

    std::vector<float> decoded_, field_, field_before_;
    std::vector<double> ways_, ways_before_;  ///< costs, with an infinity at both ends
};

}  // namespace

struct OpenLine::Self {
    static constexpr std::size_t apart = 32;  ///< columns between two whose ways are kept
    /// Costs of the ways to those entries of a column from which the seam can be reached, with
    /// infinities around.
    using Ways = std::array<double, 2 * apart + 3>;

    /// The last seam, and where it was found.
    struct Last {
        std::vector<std::uint16_t> at;  ///< entries of the window
        int number;
        const EnergyVolume* energy;
        int energy_width;
        std::size_t first, width, length;  ///< as in Line
    };

    std::size_t row_size = 0;
    /// Costs of the ways to the entries of every `apart`-th column and of the last one,
    /// `[row][entry]`.
    std::vector<double> kept;
    std::optional<Last> last;
    std::vector<double> found;
    std::vector<Extension> extensions;
    std::vector<float> decoded;
    std::array<Ways, apart> ways;

    static std::size_t rows(const Line& line) { return (line.length + apart - 2) / apart + 1; }
    static std::size_t column_of(const Line& line, std::size_t row) {
        return std::min(row * apart, line.length - 1);
    }
    std::span<double> row(const Line& line, std::size_t r) {
        return std::span(kept).subspan(r * row_size, line.width);
    }

    /// Whether the last seam is all that was deleted since.
    bool follows(const Line& line, int number) const {
        return last && number == last->number + 1 && &line.energy == last->energy &&
               line.energy.width() + 1 == last->energy_width && line.first == last->first &&
               line.width + 1 == last->width && line.length == last->length;
    }

    /// Brings the ways of a row up to date.
    /// @param changed  entries of the row before that changed; becomes those of this one
    /// @param near     entries of the columns since where energies or steps may have changed; of
    ///   the first row: all
    void update(const Line& line, std::size_t r, const EntryRange& near, EntryRange& changed) {
        const auto column = column_of(line, r);
        changed.add(near);
        if (changed.empty()) return;
        const auto range = r == 0 ? EntryRange{0, line.width}
                                  : changed.widened(column - column_of(line, r - 1), line.width);
        found.resize(range.size());
        if (r == 0) {
            const auto* const energies = line.energies(0, 0, line.width, decoded);
            std::copy_n(energies, line.width, found.begin());
        } else {
            extend_to(line, r, range);
        }
        auto* const here = row(line, r).data() + range.begin;
        std::size_t begin = 0, end = range.size();
        while (begin < end && here[begin] == found[begin]) ++begin;
        while (end > begin && here[end - 1] == found[end - 1]) --end;
        std::copy(found.begin() + static_cast<std::ptrdiff_t>(begin),
                  found.begin() + static_cast<std::ptrdiff_t>(end), here + begin);
        changed = {range.begin + begin, range.begin + end};
    }

    /// Finds the ways to entries of a row, in parts by all threads.
    void extend_to(const Line& line, std::size_t r, const EntryRange& range) {
        constexpr std::size_t least = 8 * apart;
        const auto parts = std::clamp<std::size_t>(
            range.size() / least, 1,
            static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()));
        if (extensions.size() < parts) extensions.resize(parts);
        const auto extend_part = [&](std::size_t n) {
            const EntryRange part{range.begin + range.size() * n / parts,
                                  range.begin + range.size() * (n + 1) / parts};
            extensions[n](line, column_of(line, r - 1), row(line, r - 1), column_of(line, r) + 1,
                          part, found.data() + (part.begin - range.begin));
        };
        if (parts == 1) extend_part(0);
        else tbb::parallel_for(std::size_t{0}, parts, extend_part);
    }

    /// Entries beside the last seam, in some columns, whose energies or steps may be others now.
    EntryRange near_seam(const Line& line, std::size_t first_column, std::size_t end_column) const {
        const auto columns = std::span(last->at).subspan(first_column, end_column - first_column);
        const auto [low, high] = std::ranges::minmax_element(columns);
        // Covers the energy handed on, the edges that change, and the entries with new neighbours.
        const auto margin = static_cast<std::size_t>(line.energy.spread()) + 3;
        return EntryRange{*low, *high + std::size_t{1}}.widened(margin, line.width);
    }

    /// Finds the cheapest way through all columns.
    /// @param at  becomes its entries
    /// @return its cost
    double solve(const Line& line, int number, std::vector<std::uint16_t>& at) {
        const bool goes_on = follows(line, number);
        if (!goes_on) {
            row_size = line.width;
            kept.assign(rows(line) * row_size, std::numeric_limits<double>::quiet_NaN());
        }
        EntryRange changed;
        for (std::size_t r = 0; r < rows(line); ++r) {
            const auto column = column_of(line, r);
            if (goes_on) {
                auto* const here = kept.data() + r * row_size;
                std::copy(here + last->at[column] + 1, here + line.width + 1,
                          here + last->at[column]);
            }
            update(line, r,
                   goes_on && r > 0 ? near_seam(line, column_of(line, r - 1) + 1, column + 1)
                                    : EntryRange{0, line.width},
                   changed);
        }
        const auto ends = row(line, rows(line) - 1);
        const auto least = std::ranges::min_element(ends);
        at.resize(line.length);
        at.back() = static_cast<std::uint16_t>(least - ends.begin());
        for (auto c = line.length - 1; c > 0; c = (c - 1) / apart * apart)
            go_back(line, c, number, at);
        last = Last{at,         number,     &line.energy, line.energy.width(),
                    line.first, line.width, line.length};
        return *least;
    }

    /// Cost of a way to the entry before that a step comes from, and of the step.
    /// @param to   costs of the ways to the column before
    /// @param n    of the entry, in `to`, which begins at entry `low`
    static double way_from(const Line& line, const Ways& to, std::ptrdiff_t n, int step,
                           std::size_t column, std::ptrdiff_t low) {
        const double way = to[static_cast<std::size_t>(n + step)];
        return way < endless ? way + line.step_cost(column, low + n, low + n + step) : way;
    }

    /// Follows the seam from its entry in a column back to the nearest column before whose ways
    /// were kept.
    void go_back(const Line& line, std::size_t last_column, int number,
                 std::vector<std::uint16_t>& at) {
        const auto first = (last_column - 1) / apart * apart;
        const auto reach = static_cast<std::ptrdiff_t>(last_column - first),
                   low = static_cast<std::ptrdiff_t>(at[last_column]) - reach - 1;
        // Index n stands for entry low + n.
        for (std::size_t c = first; c < last_column; ++c) {
            auto& here = ways[c - first];
            here.fill(endless);
            const auto begin = static_cast<std::size_t>(std::max<std::ptrdiff_t>(low, 0));
            const auto* const energies =
                c == first
                    ? nullptr
                    : line.energies(c, begin, std::min(line.width, begin + here.size()) - begin,
                                    decoded);
            const auto slack = static_cast<std::ptrdiff_t>(c - first) + 1;
            for (std::ptrdiff_t n = slack; n <= 2 * reach + 2 - slack; ++n) {
                const auto entry = low + n;
                if (entry < 0 || entry >= static_cast<std::ptrdiff_t>(line.width)) continue;
                const auto place = static_cast<std::size_t>(n), e = static_cast<std::size_t>(entry);
                if (!energies) {
                    here[place] = row(line, first / apart)[e];
                } else {
                    const auto& to = ways[c - first - 1];
                    const auto from = [&](int step) { return way_from(line, to, n, step, c, low); };
                    here[place] = static_cast<double>(energies[e - begin]) +
                                  std::min({from(-1), from(0), from(1)});
                }
            }
        }
        const int side = number % 2 == 0 ? -1 : 1;
        auto n = reach + 1;
        for (auto c = last_column; c-- > first;) {
            const auto way = [&](int step) {
                return way_from(line, ways[c - first], n, step, c + 1, low);
            };
            int best = 0;
            for (const int step : {side, -side})
                if (way(step) < way(best)) best = step;
            n += best;
            at[c] = static_cast<std::uint16_t>(low + n);
        }
    }
};

OpenLine::OpenLine() : self_(std::make_unique<Self>()) {}
OpenLine::~OpenLine() = default;

Seams::Seam OpenLine::operator()(const EnergyVolume& energy, Window window, int number) {
    std::vector<std::uint16_t> at;
    const auto least = self_->solve({energy, window}, number, at);
    for (auto& entry : at) entry = static_cast<std::uint16_t>(entry + window.first);
    const auto sum = energy.attracts() ? energy_of(energy, at) : least;
    return {std::move(at), sum, sum};
}

}  // namespace fluidcarve
