#include "carve/warp/find_warp.h"

#include "carve/base/each_in_parallel.h"
#include "carve/solver/costs/code.h"
#include "carve/warp/weights.h"

#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>

namespace fluidcarve {

namespace {

constexpr double tolerance = 1e-5;  ///< of a displacement, as a share of the amount
constexpr int most_cycles = 40;
constexpr int most_raises = 16;
constexpr int cycles_after_raise = 2;
/// Weights are raised until space is squeezed by this share, if all else stays.
constexpr double raised_to = 0.8;

/// A window in points of a warp: what is outside of it in vertices is outside of it in points, too.
Window points_in(const Window& window, const Warp& warp) {
    const int last_vertex = warp.vertices()[0] - 1, last_point = warp.points()[0] - 1;
    const int first = (window.first + warp.factor() - 1) / warp.factor();
    const int last = window.last == last_vertex ? last_point : window.last / warp.factor();
    return {std::min(first, last_point - 1), std::max(last, std::min(first, last_point - 1) + 1)};
}

/// A window, and how far its ends move, as shares of a column's amount.
struct Part {
    Window window;  ///< in vertices
    double low = 0, high = 0;
    bool pair = false;
};

/// The windows of a task, from below.
std::vector<Part> parts_of(const WarpTask& task) {
    if (!task.pair_window) return {{task.window, 0, 1}};
    if (!task.pair_below) return {{task.window, 0, 1}, {*task.pair_window, 1, 0, true}};
    return {{*task.pair_below, 0, -0.5, true},
            {task.window, -0.5, 0.5},
            {*task.pair_window, 0.5, 0, true}};
}

std::size_t row_of(const Warp& warp) { return static_cast<std::size_t>(warp.points()[0]); }
std::size_t columns_of(const Warp& warp) {
    return static_cast<std::size_t>(warp.points()[1]) * static_cast<std::size_t>(warp.points()[2]);
}
float length_of(const Warp& warp, int point) {
    return static_cast<float>(warp.vertex_of(0, point + 1) - warp.vertex_of(0, point));
}

float factor_of(const WarpTask& task, const Warp& warp, std::size_t t, std::size_t column) {
    return task.factors[t * static_cast<std::size_t>(warp.points()[2]) +
                        column / static_cast<std::size_t>(warp.points()[1])];
}

/// Calls `work(t, column)` for all columns in parallel.
template <class Work>
void each_column(const Warp& warp, const Work& work) {
    for (std::size_t t = 0; t < warp.frames(); ++t)
        each_in_parallel(columns_of(warp), warp_columns_per_task,
                         [&](std::size_t c) { work(t, c); });
}

/// A warp that is being found.
class Search {
public:
    Search(const WarpTask& task, Warp& warp, FrameStore& weights, const Tick& tick)
        : task_(task), warp_(warp), weights_(weights), tick_(tick), parts_(parts_of(task)) {
        for (const auto& part : parts_) windows_.push_back(points_in(part.window, warp));
    }

    int run() {
        start_evenly();
        for (const auto& window : windows_)
            systems_.push_back(
                std::make_unique<WarpSystem>(warp_, weights_, window, task_.stiffness));
        solve(tolerance, most_cycles);
        // The solution hardly ever turns back. Once it never does, amounts of one sign only
        // stretch, and amounts of the other only squeeze.
        ease_all([](double moved) { return moved < 0 ? -1.0 : 1.0; }, 0);
        warp_.set_scale(task_.amount);
        if (steepest(task_.amount) <= most_squeezed) return cycles_;
        warp_.set_linear(false);
        each_column(warp_, [&](std::size_t t, std::size_t c) {
            for (auto& value : column(t, c)) value *= static_cast<float>(task_.amount);
        });
        warp_.set_scale(1);
        for (int n = 0; n < most_raises && steepest(1) > most_squeezed; ++n) raise();
        ease_all([](double) { return 1.0; }, -most_squeezed);
        return cycles_;
    }

private:
    std::span<float> column(std::size_t t, std::size_t c) {
        return warp_.values(t).subspan(c * row_of(warp_), row_of(warp_));
    }
    std::span<std::uint16_t> codes(std::size_t t, std::size_t c) {
        return weights_.entries(t).subspan(c * row_of(warp_), row_of(warp_));
    }

    /// Even scaling: the solution where all weights are the same.
    void start_evenly() {
        each_column(warp_, [&](std::size_t t, std::size_t c) {
            const auto values = column(t, c);
            std::ranges::fill(values, 0.0f);
            for (std::size_t n = 0; n < parts_.size(); ++n) {
                const float factor = factor_of(task_, warp_, t, c),
                            low = factor * static_cast<float>(parts_[n].low),
                            high = factor * static_cast<float>(parts_[n].high);
                const auto window = windows_[n];
                const auto first = static_cast<std::size_t>(window.first),
                           last = static_cast<std::size_t>(window.last);
                const int from = warp_.vertex_of(0, window.first),
                          size = warp_.vertex_of(0, window.last) - from;
                for (auto p = first; p <= last; ++p)
                    values[p] = low + (high - low) *
                                          static_cast<float>(
                                              warp_.vertex_of(0, static_cast<int>(p)) - from) /
                                          static_cast<float>(size);
                for (auto p = last + 1; p < values.size(); ++p) values[p] = high;
            }
        });
    }

    void solve(double to, int most) {
        for (auto& system : systems_) {
            double first = 0;
            for (int n = 0; n < most; ++n) {
                const double change = system->cycle();
                ++cycles_;
                if (n == 0) first = change;
                tick_(change > 0 && first > to
                          ? std::clamp(std::log(change / first) / std::log(to / first), 0.0, 1.0)
                          : 1.0);
                if (change <= to) break;
            }
        }
    }

    /// Largest share by which space is squeezed anywhere.
    double steepest(double scale) {
        double out = 0;
        for (std::size_t t = 0; t < warp_.frames(); ++t)
            out = tbb::parallel_reduce(
                WarpColumnRange(0, columns_of(warp_), warp_columns_per_task), out,
                [&](const WarpColumnRange& range, double most) {
                    for (auto c = range.begin(); c < range.end(); ++c) {
                        const auto values = column(t, c);
                        for (std::size_t p = 0; p + 1 < values.size(); ++p)
                            most = std::max(
                                most, -scale * static_cast<double>(values[p + 1] - values[p]) /
                                          length_of(warp_, static_cast<int>(p)));
                    }
                    return most;
                },
                [](double a, double b) { return std::max(a, b); });
        return out;
    }

    /// Raises weights where space is squeezed too much, and continues from the present values.
    void raise() {
        each_column(warp_, [&](std::size_t t, std::size_t c) {
            const auto values = column(t, c);
            const auto held = codes(t, c);
            std::vector<float> factor(values.size(), 1.0f);
            for (std::size_t p = 0; p + 1 < values.size(); ++p) {
                const float squeezed =
                    (values[p] - values[p + 1]) / length_of(warp_, static_cast<int>(p));
                if (squeezed <= static_cast<float>(most_squeezed)) continue;
                for (const auto at : {p, p + 1})
                    factor[at] = std::max(factor[at], squeezed / static_cast<float>(raised_to));
            }
            for (std::size_t p = 0; p < values.size(); ++p)
                if (factor[p] > 1)
                    held[p] =
                        encode_energy(std::min(decode_energy(held[p]) * factor[p], rigid_weight));
        });
        for (auto& system : systems_) system->update_weights();
        solve(tolerance * std::abs(task_.amount), cycles_after_raise);
    }

    /// Lets no interval's slope lie below `least`.
    /// @param way  factor of slopes by the displacement of a window's end: 1, or -1 if slopes are
    ///   reversed
    template <class Way>
    void ease_all(const Way& way, double least) {
        each_column(warp_, [&](std::size_t t, std::size_t c) {
            const auto values = column(t, c);
            for (const auto& window : windows_) {
                const double moved = values[static_cast<std::size_t>(window.last)] -
                                     values[static_cast<std::size_t>(window.first)];
                ease(values, codes(t, c), window, way(moved), least);
            }
        });
    }

    /// The same in one window of a column: intervals whose slope is too low rise to `least`, and
    /// the others give way, softer ones more.
    void ease(std::span<float> values, std::span<const std::uint16_t> held, const Window& window,
              double way, double lowest) const {
        const auto first = static_cast<std::size_t>(window.first),
                   count = static_cast<std::size_t>(window.last - window.first);
        std::vector<double> steps(count), least(count), give(count);
        bool good = true;
        for (std::size_t n = 0; n < count; ++n) {
            const auto p = first + n;
            steps[n] = way * static_cast<double>(values[p + 1] - values[p]);
            least[n] = lowest * static_cast<double>(length_of(warp_, static_cast<int>(p)));
            give[n] = 1 / static_cast<double>(decode_energy(held[p]) + decode_energy(held[p + 1]));
            good = good && steps[n] >= least[n];
        }
        if (good) return;
        // The steps must add up as before: find by how much the others must give way.
        const auto total = way * static_cast<double>(values[first + count] - values[first]);
        const auto pressed = [&](std::size_t n, double by) {
            return std::max(least[n], steps[n] - by * give[n]);
        };
        const auto sum = [&](double by) {
            double out = 0;
            for (std::size_t n = 0; n < count; ++n) out += pressed(n, by);
            return out;
        };
        double low = 0, high = 1;
        while (sum(high) > total && high < 0x1p60) high *= 2;
        constexpr int halvings = 60;
        for (int n = 0; n < halvings; ++n)
            (sum((low + high) / 2) > total ? low : high) = (low + high) / 2;
        double at = static_cast<double>(values[first]);
        for (std::size_t n = 0; n + 1 < count; ++n)
            values[first + n + 1] = static_cast<float>(at += way * pressed(n, high));
    }

    const WarpTask& task_;
    Warp& warp_;
    FrameStore& weights_;
    const Tick& tick_;
    std::vector<Part> parts_;
    std::vector<Window> windows_;  ///< of each part, in points
    std::vector<std::unique_ptr<WarpSystem>> systems_;
    int cycles_ = 0;
};

/// The room of one column, and where it is.
struct Room {
    double ratio = 1;  ///< available room as a share of the wanted room; 1: enough
    std::size_t t = 0, column = 0, free = 0, intervals = 0;
    Part part;
};

/// The room in a window of a column.
/// @param squeezed  vertices by which it is to become shorter; below 0: longer
Room room_in(const Warp& warp, std::span<const std::uint16_t> codes, const Window& window,
             double squeezed) {
    const auto rigid = [&](int p) {
        return decode_energy(codes[static_cast<std::size_t>(p)]) >= least_rigid_weight;
    };
    Room out;
    double room = 0;
    for (int p = window.first; p < window.last; ++p, ++out.intervals) {
        if (rigid(p) || rigid(p + 1)) continue;
        ++out.free;
        room += most_squeezed * static_cast<double>(length_of(warp, p));
    }
    if (squeezed > 0) out.ratio = std::min(room / squeezed, 1.0);
    else if (squeezed < 0 && out.free == 0) out.ratio = 0;
    return out;
}

}  // namespace

std::optional<NoRoom> no_room(const WarpTask& task, const Warp& warp, const FrameStore& weights) {
    const auto least = [](const Room& a, const Room& b) { return b.ratio < a.ratio ? b : a; };
    const auto parts = parts_of(task);
    Room found;
    for (std::size_t t = 0; t < warp.frames(); ++t)
        found = tbb::parallel_reduce(
            WarpColumnRange(0, columns_of(warp), warp_columns_per_task), found,
            [&](const WarpColumnRange& range, Room out) {
                for (auto c = range.begin(); c < range.end(); ++c) {
                    const double moved =
                        task.amount * static_cast<double>(factor_of(task, warp, t, c));
                    for (const auto& part : parts) {
                        auto room = room_in(
                            warp, weights.entries(t).subspan(c * row_of(warp), row_of(warp)),
                            points_in(part.window, warp), moved * (part.low - part.high));
                        room.t = t;
                        room.column = c;
                        room.part = part;
                        out = least(out, room);
                    }
                }
                return out;
            },
            // Ranges are joined from left to right: of equal columns the first counts.
            least);
    if (found.ratio >= 1) return std::nullopt;
    const auto laterals = static_cast<std::size_t>(warp.points()[1]);
    return NoRoom{task.amount * found.ratio,
                  warp.vertex_of(1, static_cast<int>(found.column % laterals)),
                  warp.vertex_of(2, static_cast<int>(found.column / laterals)),
                  found.t,
                  found.part.window,
                  found.part.pair,
                  found.free,
                  found.intervals};
}

int find_warp(const WarpTask& task, Warp& warp, FrameStore& weights, const Tick& tick) {
    return Search(task, warp, weights, tick).run();
}

double most_linear(const Warp& warp, int sign) {
    const auto& slope = warp.bounds().slope;
    const double squeezed = static_cast<double>(sign > 0 ? -slope.least : slope.most);
    return squeezed > 0 ? most_squeezed / squeezed : std::numeric_limits<double>::infinity();
}

}  // namespace fluidcarve
