#include "carve/solver/task/task_bounds.h"

#include "carve/solver/search/columns.h"
#include "carve/solver/search/strip.h"

#include <cstddef>
#include <utility>

namespace fluidcarve {

namespace {

/// Up to this many energies, each seam gets a bound, which takes no longer than a search.
constexpr std::size_t most_entries_bounded = std::size_t{1} << 24;
/// Passes beyond the usual for the one bound of larger sets.
constexpr int passes_of_large = 1;

bool few(const EnergyVolume& energy, Window window) {
    return Columns(energy).count() * static_cast<std::size_t>(window.size()) <=
           most_entries_bounded;
}

}  // namespace

TaskBounds::TaskBounds(std::optional<int> passes, int before, std::function<void()> check,
                       Limits limits)
    : passes_(passes),
      before_(before),
      check_(std::move(check)),
      limits_(std::move(limits)),
      consecutive_(limits_) {}

bool TaskBounds::find(const EnergyVolume& energy, Window window, int number, const Tick& tick) {
    if (!few(energy, window)) return false;
    if (!found_) found_ = consecutive_(energy, window, number, passes_.value_or(0), tick);
    return true;
}

std::optional<double> TaskBounds::energy_bound(const EnergyVolume& energy, Window window,
                                               std::span<const std::uint16_t> found, int number,
                                               const Tick& tick) {
    if (find(energy, window, number, tick)) return fluidcarve::energy_bound(energy, found, *found_);
    if (!passes_ && number > 0) return std::nullopt;
    return fluidcarve::energy_bound(
        energy, found,
        lower_bound(energy, window, passes_.value_or(passes_of_large), tick, limits_));
}

void TaskBounds::follow(const EnergyVolume& energy, Window window,
                        std::span<const std::uint16_t> at, int number) {
    // Messages of known seams are passed again, as far as later seams share them.
    if (number < before_ && number >= ConsecutiveBounds::first_with(before_))
        find(energy, window, number, [&](double) { check_(); });
    if (found_) consecutive_.follow(at, number);
    found_.reset();
}

}  // namespace fluidcarve
