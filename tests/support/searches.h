#pragma once

#include "carve/solver/greedy.h"
#include "carve/solver/search/columns.h"
#include "carve/solver/search/find_seams.h"
#include "tests/support/brute_force.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

/// What tests of searches hand to them.
namespace fluidcarve::test {

/// Heeds no progress.
inline const Tick nobody = [](double) {};
inline const auto quiet = [] {};

inline FindSeam greedy(int starts) {
    return [=](const EnergyVolume& energy, Window window, int number, const Tick& tick) {
        return greedy_seam(energy, window, number, starts, tick);
    };
}

inline Columns columns_of(const ColumnGraph& graph) {
    return {graph.size[0], graph.size[1], graph.size[2], graph.closed, graph.around};
}

/// A call's result when that many threads work on it.
template <class Call>
auto with_threads(int threads, const Call& call) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    tbb::task_arena arena(threads);
    return arena.execute(call);
}

}  // namespace fluidcarve::test
