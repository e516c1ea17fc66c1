#include "nodes/seam/search/bound.h"

#include "nodes/seam/search/columns.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <vector>

namespace fluidcarve {

namespace {

/// Share of an entry's surplus that is handed on. More leaves nothing for the rest of the line, less takes more passes.
constexpr float handed_on = 0.1f;

/// Largest rounding error of a sum of floats along a line, as a share of the sum, with room.
double rounding(std::size_t length) { return std::max(1e-5, static_cast<double>(length) * 0x1p-23); }

/// For each entry, the least cost among its neighbours within 1.
void spread(const float* from, float* to, std::size_t width) {
    if (width == 1) {
        to[0] = from[0];
        return;
    }
    to[0] = std::min(from[0], from[1]);
    for (std::size_t i = 1; i + 1 < width; ++i) to[i] = std::min({from[i - 1], from[i], from[i + 1]});
    to[width - 1] = std::min(from[width - 2], from[width - 1]);
}

/// The same if steps cost something.
/// @param first  the entry at index 0
void spread(const float* from, std::size_t column_from, float* to, std::size_t column_to, std::size_t width, int first, const StepCosts& steps, bool in_time) {
    if (!steps) return spread(from, to, width);
    for (std::size_t i = 0; i < width; ++i) {
        const int entry = first + static_cast<int>(i);
        to[i] = from[i];
        if (i > 0) to[i] = std::min(to[i], from[i - 1] + steps.lift(column_to, column_from, entry - 1, in_time));
        if (i + 1 < width) to[i] = std::min(to[i], from[i + 1] + steps.lift(column_from, column_to, entry, in_time));
    }
}

/// The lines of columns along one dimension.
struct Lines {
    std::size_t first_step, second_step, step, length, first_count, count;

    Lines(const Columns& columns, std::size_t along) {
        const std::array<std::size_t, 3> size{columns.laterals(), columns.slices(), columns.frames()};
        const std::array<std::size_t, 3> steps{1, columns.laterals(), columns.per_frame()};
        const auto first = along == 0 ? 1u : 0u, second = along == 2 ? 1u : 2u;
        first_step = steps[first];
        second_step = steps[second];
        step = steps[along];
        length = size[along];
        first_count = size[first];
        count = size[first] * size[second];
    }
    std::size_t begin(std::size_t line) const { return line % first_count * first_step + line / first_count * second_step; }
};

/// Sums the minima of all lines in a fixed order, each reduced by its possible rounding error.
/// @param minimum  called with a line's first column; returns the line's minimum
template <class Minimum>
double sum_of_lines(const Lines& lines, const Minimum& minimum) {
    std::vector<double> minima(lines.count);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, lines.count, 16), [&](const tbb::blocked_range<std::size_t>& range) {
        std::vector<float> scratch;
        for (auto n = range.begin(); n < range.end(); ++n) {
            const double least = minimum(lines.begin(n), scratch);
            minima[n] = least - rounding(lines.length) * std::abs(least);
        }
    });
    return std::accumulate(minima.begin(), minima.end(), 0.0);
}

std::vector<std::size_t> dimensions(const Columns& columns) {
    std::vector<std::size_t> out;
    for (const auto& [d, size] : {std::pair(0, columns.laterals()), std::pair(1, columns.slices()), std::pair(2, columns.frames())})
        if (size > 1) out.push_back(static_cast<std::size_t>(d));
    if (out.empty()) out.push_back(0);
    return out;
}

/// The bound of the even split alone, which needs no memory.
template <class Cell>
double even_split(const EnergyVolume& energy, const Columns& columns, Window window) {
    const auto width = static_cast<std::size_t>(window.size());
    const auto all = dimensions(columns);
    const auto cost = energy.costs();
    const auto steps = energy.steps();
    const float share = 1 / static_cast<float>(all.size());
    double sum = 0;
    for (const auto along : all) {
        const Lines lines(columns, along);
        sum += sum_of_lines(lines, [&](std::size_t begin, std::vector<float>& scratch) {
            scratch.assign(2 * width, 0.0f);
            auto *way = scratch.data(), *next = way + width;
            for (std::size_t n = 0; n < lines.length; ++n) {
                const auto c = begin + n * lines.step;
                const auto* const cells = energy.cells<Cell>(c / columns.per_frame()) + c % columns.per_frame() * energy.stride() + window.first;
                if (n > 0) {
                    spread(way, c - lines.step, next, c, width, window.first, steps, along == 2);
                    std::swap(way, next);
                }
                for (std::size_t i = 0; i < width; ++i) way[i] += share * cost(cells[i]);
            }
            return static_cast<double>(*std::min_element(way, way + width));
        });
    }
    return sum;
}

/// The parts of the energy, one for each dimension, `[column][entry]`.
template <class Cell>
class Split {
public:
    Split(const EnergyVolume& energy, const Columns& columns, Window window)
        : columns_(columns),
          all_(dimensions(columns)),
          width_(static_cast<std::size_t>(window.size())),
          first_(window.first),
          steps_(energy.steps()),
          parts_(all_.size()) {
        for (auto& part : parts_) part.resize(columns.count() * width_);
        tbb::parallel_for(std::size_t{0}, columns.slices() * columns.frames(), [&, cost = energy.costs()](std::size_t row) {
            for (auto c = row * columns.laterals(); c < (row + 1) * columns.laterals(); ++c) {
                const auto* const cells = energy.cells<Cell>(c / columns.per_frame()) + c % columns.per_frame() * energy.stride() + window.first;
                for (std::size_t i = 0; i < width_; ++i)
                    for (auto& part : parts_) part[c * width_ + i] = cost(cells[i]) / static_cast<float>(parts_.size());
            }
        });
    }

    /// Hands surplus on from the lines of one part, if there are other parts.
    /// @return the sum of the lines' minima before
    double pass(std::size_t own) {
        const Lines lines(columns_, all_[own]);
        const bool in_time = all_[own] == 2;
        return sum_of_lines(lines, [&](std::size_t begin, std::vector<float>& scratch) {
            const auto here = [&](std::size_t n) { return parts_[own].data() + (begin + n * lines.step) * width_; };
            // First the cheapest ways from the front to each column, without the column itself. Then those from the back, handing surplus
            // on.
            scratch.assign((lines.length + 3) * width_, 0.0f);
            auto *const back = scratch.data() + lines.length * width_, *const way = back + width_, *const surplus = way + width_;
            for (std::size_t n = 1; n < lines.length; ++n) {
                auto* const front = scratch.data() + n * width_;
                for (std::size_t i = 0; i < width_; ++i) way[i] = front[i - width_] + here(n - 1)[i];
                const auto c = begin + n * lines.step;
                spread(way, c - lines.step, front, c, width_, first_, steps_, in_time);
            }
            double minimum = 0;
            for (auto n = lines.length; n-- > 0;) {
                auto* const part = here(n);
                const auto* const front = scratch.data() + n * width_;
                for (std::size_t i = 0; i < width_; ++i) surplus[i] = front[i] + part[i] + back[i];
                const auto least = *std::min_element(surplus, surplus + width_);
                if (n + 1 == lines.length) minimum = least;
                hand_on(own, static_cast<std::size_t>(part - parts_[own].data()), surplus, least);
                if (n == 0) break;
                for (std::size_t i = 0; i < width_; ++i) way[i] = part[i] + back[i];
                const auto c = begin + n * lines.step;
                spread(way, c, back, c - lines.step, width_, first_, steps_, in_time);
            }
            return minimum;
        });
    }
    double minima() {
        double sum = 0;
        for (std::size_t own = 0; own < parts_.size(); ++own) sum += pass(own);
        return sum;
    }
    std::size_t parts() const { return parts_.size(); }

private:
    void hand_on(std::size_t own, std::size_t at, const float* surplus, float least) {
        if (parts_.size() == 1) return;
        const float share = handed_on / static_cast<float>(parts_.size() - 1);
        for (std::size_t n = 0; n < parts_.size(); ++n) {
            auto* const part = parts_[n].data() + at;
            const float factor = n == own ? -handed_on : share;
            // Entries that protected ones cut off hand nothing on.
            for (std::size_t i = 0; i < width_; ++i)
                if (!std::isinf(surplus[i])) part[i] += factor * (surplus[i] - least);
        }
    }

    const Columns& columns_;
    const std::vector<std::size_t> all_;
    const std::size_t width_;
    const int first_;
    const StepCosts steps_;
    std::vector<std::vector<float>> parts_;
};

}  // namespace

double lower_bound(const EnergyVolume& energy, Window window, int passes, const Tick& tick) {
    const Columns columns(energy);
    const auto in = [&](auto cell) {
        using Cell = decltype(cell);
        if (passes == 0) return even_split<Cell>(energy, columns, window);
        Split<Cell> split(energy, columns, window);
        double bound = 0;
        // A part's minimum is taken before it hands on, and does not fall after that. So the sum holds for the parts as they are after a
        // round.
        for (int n = 0; n <= passes; ++n) {
            tick(static_cast<double>(n) / (passes + 1));
            bound = split.minima();
        }
        return bound;
    };
    return energy.summed() ? in(float{}) : in(std::uint16_t{});
}

}  // namespace fluidcarve
