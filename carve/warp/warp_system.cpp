#include "carve/warp/warp_system.h"

#include "carve/solver/costs/decode.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace fluidcarve {

namespace {

/// Columns solved together, so that the divisions of one do not wait for each other.
constexpr std::size_t columns_together = 4;
/// A level of at most so many columns is solved by sweeps alone.
constexpr std::size_t coarsest_columns = 8;
constexpr int coarsest_sweeps = 16;
constexpr int coarse_cycles = 2;  ///< of a coarser level in each cycle of the next finer one
/// A dimension whose coupling is below this share of the strongest is coarsened later than the
/// others.
constexpr double weak_coupling = 0.25;

}  // namespace

/// The points at one resolution across the axis. Columns are counted `[t][k][lateral]`. The finest
/// level refers to the warp and its weights; a coarser one solves for a correction, which is 0 at
/// both ends.
class WarpSystem::Level {
public:
    Level(Warp& warp, const FrameStore& weights, Window window, const WarpStiffness& stiffness)
        : size_{warp.points()[1], warp.points()[2], static_cast<int>(warp.frames())},
          rings_{warp.rings().lateral, warp.rings().w, false},
          width_(static_cast<std::size_t>(window.size())),
          coupling_{stiffness.space, stiffness.space,
                    stiffness.time * warp.factor() * warp.factor()},
          warp_(&warp),
          codes_(&weights),
          first_(static_cast<std::size_t>(window.first)) {
        for (int p = window.first; p < window.last; ++p)
            inverse_length_.push_back(
                static_cast<float>(warp.factor()) /
                static_cast<float>(warp.vertex_of(0, p + 1) - warp.vertex_of(0, p)));
        fixed_.resize(columns());
        for (std::size_t c = 0; c < columns(); ++c)
            fixed_[c] = value(c)[0] == 0 && value(c)[width_ - 1] == 0;
    }

    /// The next coarser level. @param finer  must outlive this
    explicit Level(const Level& finer)
        : size_(finer.size_),
          rings_(finer.rings_),
          width_(finer.width_),
          coupling_(finer.coupling_),
          inverse_length_(finer.inverse_length_) {
        const double strongest = finer.strongest();
        for (std::size_t d = 0; d < 3; ++d) {
            if (size_[d] == 1 || coupling_[d] < weak_coupling * strongest) continue;
            halved_[d] = true;
            size_[d] = (size_[d] + 1) / 2;
            coupling_[d] /= 4;
        }
        weights_.resize(columns() * width_);
        values_.resize(columns() * width_);
        wanted_.resize(columns() * width_);
        fixed_.resize(columns());
        for (std::size_t c = 0; c < columns(); ++c)
            each_child(finer, c,
                       [&](std::size_t child) { fixed_[c] = fixed_[c] || finer.fixed_[child]; });
        average_weights(finer);
    }

    std::size_t columns() const {
        return static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
               static_cast<std::size_t>(size_[2]);
    }
    bool coarsest() const { return columns() <= coarsest_columns || strongest() == 0; }

    /// Sets each weight to the mean of those that it stands for.
    void average_weights(const Level& finer) {
        tbb::parallel_for(WarpColumnRange(0, columns(), warp_columns_per_task),
                          [&](const WarpColumnRange& range) {
                              std::vector<float> line(width_);
                              for (auto c = range.begin(); c < range.end(); ++c) {
                                  const auto out = std::span(weights_).subspan(c * width_, width_);
                                  mean_of_children(finer, c, out, [&](std::size_t child) {
                                      finer.load_weights(child, line);
                                      for (std::size_t p = 0; p < width_; ++p) out[p] += line[p];
                                  });
                              }
                          });
    }

    /// Solves every column once, with its neighbours fixed. @return the greatest change
    double sweep() {
        double change = 0;
        for (int turn = 0; turn < turns(); ++turn)
            change = std::max(
                change, tbb::parallel_reduce(
                            WarpColumnRange(0, columns(), warp_columns_per_task), 0.0,
                            [&](const WarpColumnRange& range, double most) {
                                std::vector<Lines> lines(columns_together, Lines(width_));
                                std::vector<std::size_t> columns;
                                for (auto c = range.begin(); c < range.end(); ++c) {
                                    if (!fixed_[c] && turn_of(place(c)) == turn)
                                        columns.push_back(c);
                                    if (columns.size() < columns_together && c + 1 < range.end())
                                        continue;
                                    most = std::max(most, solve_columns(columns, lines));
                                    columns.clear();
                                }
                                return most;
                            },
                            [](double a, double b) { return std::max(a, b); }));
        return change;
    }

    /// Sets the equations of the correction to the mean of the finer level's residuals, and the
    /// correction to 0.
    void restrict_from(const Level& finer) {
        std::ranges::fill(values_, 0.0f);
        tbb::parallel_for(WarpColumnRange(0, columns(), warp_columns_per_task),
                          [&](const WarpColumnRange& range) {
                              Lines lines(width_);
                              for (auto c = range.begin(); c < range.end(); ++c) {
                                  const auto out = std::span(wanted_).subspan(c * width_, width_);
                                  if (fixed_[c]) std::ranges::fill(out, 0.0f);
                                  else
                                      mean_of_children(finer, c, out, [&](std::size_t child) {
                                          finer.add_residual(child, lines, out);
                                      });
                              }
                          });
    }

    /// Adds a coarser level's correction, linear between its columns.
    void correct(const Level& coarser) {
        tbb::parallel_for(WarpColumnRange(0, columns(), warp_columns_per_task),
                          [&](const WarpColumnRange& range) {
                              std::vector<float> line(width_);
                              for (auto c = range.begin(); c < range.end(); ++c) {
                                  if (fixed_[c]) continue;
                                  std::ranges::fill(line, 0.0f);
                                  coarser.add_interpolated(place(c), line);
                                  float* const at = value(c);
                                  for (std::size_t p = 1; p + 1 < width_; ++p) at[p] += line[p];
                              }
                          });
    }

private:
    using Place = std::array<int, 3>;  ///< lateral, k, t

    /// Buffers for the work on a column.
    struct Lines {
        explicit Lines(std::size_t width)
            : own(width),
              other(width),
              diagonal(width),
              wanted(width),
              factor(width),
              result(width) {}
        std::vector<float> own, other;       ///< weights of the column, and of a neighbouring one
        std::vector<float> diagonal;         ///< sums of the couplings to neighbouring columns
        std::vector<float> wanted;           ///< right-hand side: all known terms
        std::vector<double> factor, result;  ///< of the elimination
    };

    double strongest() const {
        double out = 0;
        for (std::size_t d = 0; d < 3; ++d)
            if (size_[d] > 1) out = std::max(out, coupling_[d]);
        return out;
    }

    Place place(std::size_t c) const {
        const auto laterals = static_cast<std::size_t>(size_[0]),
                   slices = static_cast<std::size_t>(size_[1]);
        return {static_cast<int>(c % laterals), static_cast<int>(c / laterals % slices),
                static_cast<int>(c / laterals / slices)};
    }
    std::size_t column(const Place& at) const {
        return static_cast<std::size_t>(at[0]) +
               static_cast<std::size_t>(size_[0]) *
                   (static_cast<std::size_t>(at[1]) +
                    static_cast<std::size_t>(size_[1]) * static_cast<std::size_t>(at[2]));
    }
    std::size_t per_frame() const {
        return static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]);
    }

    /// In a ring of an odd number of columns the first and the last are neighbours in one turn: the
    /// last one waits.
    bool last_waits(std::size_t d) const { return rings_[d] && size_[d] % 2 == 1 && size_[d] > 1; }
    int turns() const { return 2 * (last_waits(0) ? 2 : 1) * (last_waits(1) ? 2 : 1); }
    /// Turn in which a column is solved, never together with a neighbour.
    int turn_of(const Place& at) const {
        int out = (at[0] + at[1] + at[2]) % 2, later = 2;
        for (std::size_t d = 0; d < 2; ++d) {
            if (!last_waits(d)) continue;
            if (at[d] == size_[d] - 1) out += later;
            later *= 2;
        }
        return out;
    }

    /// Calls `visit(column, coupling)` for the neighbours of a place.
    template <class Visit>
    void each_neighbour(const Place& at, const Visit& visit) const {
        for (std::size_t d = 0; d < 3; ++d)
            for (const int step : {-1, 1}) {
                auto beside = at;
                beside[d] += step;
                if (beside[d] < 0 || beside[d] >= size_[d]) {
                    // Two columns in a ring are neighbours on both sides.
                    if (!rings_[d] || size_[d] < 2) continue;
                    beside[d] = (beside[d] + size_[d]) % size_[d];
                }
                visit(column(beside), coupling_[d]);
            }
    }

    /// Calls `visit(child)` for the columns of the finer level that a column stands for.
    template <class Visit>
    void each_child(const Level& finer, std::size_t c, const Visit& visit) const {
        const auto at = place(c);
        Place low{}, high{};
        for (std::size_t d = 0; d < 3; ++d) {
            low[d] = halved_[d] ? 2 * at[d] : at[d];
            high[d] = halved_[d] ? std::min(low[d] + 1, finer.size_[d] - 1) : low[d];
        }
        for (int t = low[2]; t <= high[2]; ++t)
            for (int k = low[1]; k <= high[1]; ++k)
                for (int lateral = low[0]; lateral <= high[0]; ++lateral)
                    visit(finer.column({lateral, k, t}));
    }
    /// Sets `into` to the mean of the columns of the finer level that column `c` stands for.
    /// @param add  adds one of them to `into`
    template <class Add>
    void mean_of_children(const Level& finer, std::size_t c, std::span<float> into,
                          const Add& add) const {
        std::ranges::fill(into, 0.0f);
        float count = 0;
        each_child(finer, c, [&](std::size_t child) {
            add(child);
            ++count;
        });
        for (auto& value : into) value /= count;
    }

    const float* value(std::size_t c) const { return const_cast<Level*>(this)->value(c); }
    float* value(std::size_t c) {
        if (!warp_) return values_.data() + c * width_;
        return warp_->values(c / per_frame()).data() +
               c % per_frame() * static_cast<std::size_t>(warp_->points()[0]) + first_;
    }

    void load_weights(std::size_t c, std::span<float> out) const {
        if (!warp_) {
            std::ranges::copy(std::span(weights_).subspan(c * width_, width_), out.begin());
            return;
        }
        const auto codes =
            codes_->entries(c / per_frame())
                .subspan(c % per_frame() * static_cast<std::size_t>(warp_->points()[0]) + first_,
                         width_);
        decode_energies(codes, out);
    }

    /// Sets up a column's equations: its couplings to its neighbours.
    void couple(std::size_t c, Lines& lines) const {
        load_weights(c, lines.own);
        std::ranges::fill(lines.diagonal, 0.0f);
        if (warp_) std::ranges::fill(lines.wanted, 0.0f);
        else
            std::ranges::copy(std::span(wanted_).subspan(c * width_, width_), lines.wanted.begin());
        each_neighbour(place(c), [&](std::size_t beside, double coupling) {
            load_weights(beside, lines.other);
            const float half = 0.5f * static_cast<float>(coupling);
            const float *const there = value(beside), *const own = lines.own.data(),
                               *const other = lines.other.data();
            float *const diagonal = lines.diagonal.data(), *const wanted = lines.wanted.data();
            for (std::size_t p = 0; p < width_; ++p) {
                const float link = half * (own[p] + other[p]);
                diagonal[p] += link;
                wanted[p] += link * there[p];
            }
        });
    }
    /// Coupling of a point to the next one along the axis.
    double along(const Lines& lines, std::size_t p) const {
        return 0.5 * (lines.own[p] + lines.own[p + 1]) * inverse_length_[p];
    }

    /// Solves the columns of one turn with their neighbours fixed. @return the greatest change
    double solve_columns(const std::vector<std::size_t>& columns, std::vector<Lines>& lines) {
        std::array<float*, columns_together> at{};
        std::array<double, columns_together> below{}, last{};
        for (std::size_t n = 0; n < columns.size(); ++n) {
            couple(columns[n], lines[n]);
            at[n] = value(columns[n]);
            lines[n].factor[0] = 0;
            lines[n].result[0] = at[n][0];
            below[n] = along(lines[n], 0);
            last[n] = at[n][width_ - 1];
        }
        for (std::size_t p = 1; p + 1 < width_; ++p)
            for (std::size_t n = 0; n < columns.size(); ++n) {
                auto& line = lines[n];
                const double above = along(line, p),
                             inverse = 1 / (line.diagonal[p] + above +
                                            below[n] * (1 - line.factor[p - 1]));
                line.factor[p] = above * inverse;
                line.result[p] = (line.wanted[p] + below[n] * line.result[p - 1]) * inverse;
                below[n] = above;
            }
        double change = 0;
        for (std::size_t p = width_ - 2; p > 0; --p)
            for (std::size_t n = 0; n < columns.size(); ++n) {
                last[n] = lines[n].result[p] + lines[n].factor[p] * last[n];
                change = std::max(change, std::abs(last[n] - at[n][p]));
                at[n][p] = static_cast<float>(last[n]);
            }
        return change;
    }

    void add_residual(std::size_t c, Lines& lines, std::span<float> out) const {
        if (fixed_[c]) return;
        couple(c, lines);
        const float* const at = value(c);
        double below = along(lines, 0) * (at[1] - at[0]);
        for (std::size_t p = 1; p + 1 < width_; ++p) {
            const double above = along(lines, p) * (at[p + 1] - at[p]);
            out[p] +=
                static_cast<float>(lines.wanted[p] - lines.diagonal[p] * at[p] + above - below);
            below = above;
        }
    }

    /// Adds the values at a place of the finer level.
    void add_interpolated(const Place& finer, std::span<float> out) const {
        struct Part {
            std::array<int, 2> at;
            std::array<float, 2> share;
        };
        std::array<Part, 3> parts;
        for (std::size_t d = 0; d < 3; ++d) {
            parts[d] = {{finer[d], finer[d]}, {1, 0}};
            if (!halved_[d]) continue;
            const int near = finer[d] / 2, beside = near + (finer[d] % 2 == 1 ? 1 : -1);
            parts[d] = {{near, rings_[d] ? (beside + size_[d]) % size_[d]
                                         : std::clamp(beside, 0, size_[d] - 1)},
                        {0.75f, 0.25f}};
        }
        for (int corner = 0; corner < 8; ++corner) {
            Place at{};
            float share = 1;
            for (std::size_t d = 0; d < 3; ++d) {
                const auto side = static_cast<std::size_t>(corner >> d & 1);
                at[d] = parts[d].at[side];
                share *= parts[d].share[side];
            }
            if (share == 0) continue;
            const float* const there = value(column(at));
            for (std::size_t p = 0; p < width_; ++p) out[p] += share * there[p];
        }
    }

    std::array<int, 3> size_;         ///< columns laterally, along w and in time
    std::array<bool, 3> rings_;       ///< dimensions whose last column is followed by their first
    std::size_t width_;               ///< points of a column
    std::array<double, 3> coupling_;  ///< stiffness laterally, along w and in time
    std::array<bool, 3> halved_{};    ///< which dimensions have half of the finer level's columns
    std::vector<float> inverse_length_;             ///< of the intervals along the axis
    std::vector<std::uint8_t> fixed_;               ///< `[column]`: whether the column stays as it
                                                    ///< is
    Warp* warp_ = nullptr;                          ///< of the finest level; null in others
    const FrameStore* codes_ = nullptr;             ///< weights of the finest level
    std::size_t first_ = 0;                         ///< point of the warp with which columns begin
    std::vector<float> weights_, values_, wanted_;  ///< of coarser levels, `[column][point]`
};

WarpSystem::WarpSystem(Warp& warp, const FrameStore& weights, Window window,
                       const WarpStiffness& stiffness) {
    levels_.push_back(std::make_unique<Level>(warp, weights, window, stiffness));
    while (!levels_.back()->coarsest()) levels_.push_back(std::make_unique<Level>(*levels_.back()));
}

WarpSystem::~WarpSystem() = default;

void WarpSystem::update_weights() {
    for (std::size_t n = 1; n < levels_.size(); ++n) levels_[n]->average_weights(*levels_[n - 1]);
}

double WarpSystem::cycle() { return cycle(0); }

double WarpSystem::cycle(std::size_t n) {
    auto& level = *levels_[n];
    if (n + 1 == levels_.size()) {
        double change = level.sweep();
        for (int more = 1; more < coarsest_sweeps && change > 0; ++more) change = level.sweep();
        return change;
    }
    level.sweep();
    auto& coarser = *levels_[n + 1];
    coarser.restrict_from(level);
    for (int times = 0; times < coarse_cycles; ++times) cycle(n + 1);
    level.correct(coarser);
    return level.sweep();
}

}  // namespace fluidcarve
