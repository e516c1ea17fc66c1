#include "tests/bench/warp.h"

#include "carve/seam/warp.h"
#include "carve/solver/costs/prices.h"
#include "carve/solver/greedy.h"
#include "carve/warp/find_warp.h"
#include "carve/warp/weights.h"
#include "tests/bench/measure.h"
#include "tests/support/synthetic_energy.h"

#include <array>
#include <cstddef>
#include <vector>

using namespace fluidcarve;

namespace {

/// Finds the warp of a smoke's energy, and one greedy seam in it.
/// @param factor  vertices from point to point of the warp
void bench_size(const std::array<int, 3>& shape, std::size_t frames, int factor) {
    const auto energy = test::SyntheticEnergy(test::Synthetic::smoke, 3)(shape, frames);
    const int runs = factor == 1 ? 3 : 1;
    const auto typical = Typical::of(energy);  // comes with the energies
    int cycles = 0;
    const auto warp = [&] {
        return seconds(runs, [&] {
            Warp found(shape, {}, factor, frames);
            FrameStore weights(frames, found.values(0).size());
            find_weights(energy, typical, {}, found, weights);
            WarpTask task;
            task.window = {0, shape[0] - 1};
            task.factors.assign(static_cast<std::size_t>(found.points()[2]) * frames, 1.0f);
            task.amount = -0.1 * shape[0];
            cycles = find_warp(task, found, weights, [](double) {});
        });
    };
    const double seam = with_threads(2, [&] {
        return seconds(runs, [&] { greedy_seam(energy, {0, shape[0] - 1}, 0, 16, [](double) {}); });
    });
    const auto name =
        fmt::format("{}x{}x{} x {}: warp.solve", shape[0], shape[1], shape[2], frames);
    const double two = with_threads(2, warp);
    line(fmt::format("{}, a point every {} / a greedy seam", name,
                     factor == 1 ? "vertex" : fmt::format("{} vertices", factor)),
         two / seam, fmt::format("{:.2f} s, {} cycles; {:.2f} s", two, cycles, seam),
         Better::lower);
    if (factor == 1) scaling(name, warp);
}

}  // namespace

void bench_warp(bool large) {
    bench_size({161, 52, 165}, 20, 1);
    if (large) bench_size({322, 105, 331}, 84, 4);
}
