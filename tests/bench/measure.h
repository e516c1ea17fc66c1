#pragma once

#include "tests/bench/kept.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

/// Median seconds of several calls.
inline double seconds(int runs, const std::function<void()>& call) {
    std::vector<double> all;
    for (int n = 0; n < runs; ++n) {
        const auto start = std::chrono::steady_clock::now();
        call();
        all.push_back(
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    std::ranges::sort(all);
    return all[all.size() / 2];
}

inline double with_threads(int threads, const std::function<double()>& measure) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(threads));
    tbb::task_arena arena(threads);
    return arena.execute(measure);
}

/// All lines of this run.
inline std::vector<Figure>& figures() {
    static std::vector<Figure> all;
    return all;
}

/// Prints a line and remembers it.
inline void line(const std::string& what, double ratio, const std::string& rest = {},
                 Better better = Better::higher) {
    fmt::print("{:<80} {:>8.2f}   {}\n", what, ratio, rest);
    figures().push_back(
        {what, ratio, better, rest, fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)))});
}

inline void scaling(const std::string& what, const std::function<double()>& measure) {
    const double one = with_threads(1, measure), two = with_threads(2, measure);
    line(what + ": 1 thread / 2 threads", one / two, fmt::format("{:.3f} s, {:.3f} s", one, two));
}
