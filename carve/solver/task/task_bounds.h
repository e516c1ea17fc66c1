#pragma once

#include "carve/base/limits.h"
#include "carve/solver/search/bound.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>

namespace fluidcarve {

/// The bounds of a task's seams. In small volumes each seam has one; in large ones the first, or
/// all if passes are stated.
class TaskBounds : public SeamBounds {
public:
    /// @param passes  of lower_bound(); nothing: as few as there may be
    /// @param before  number of seams that an earlier search found; bounds after
    ///   them are those of an uninterrupted search
    /// @param check   called now and then; stops the work by throwing
    /// @param limits  as for lower_bound()
    TaskBounds(std::optional<int> passes, int before, std::function<void()> check, Limits limits);

    bool find(const EnergyVolume& energy, Window window, int number, const Tick& tick) override;
    double with(const SeamStart& start) const override { return consecutive_.with(start); }
    std::optional<double> energy_bound(const EnergyVolume& energy, Window window,
                                       std::span<const std::uint16_t> found, int number,
                                       const Tick& tick) override;
    void follow(const EnergyVolume& energy, Window window, std::span<const std::uint16_t> at,
                int number) override;

private:
    std::optional<int> passes_;
    int before_;
    std::function<void()> check_;
    Limits limits_;
    ConsecutiveBounds consecutive_;
    std::optional<double> found_;  ///< by the last find(), for a seam that is not deleted yet
};

}  // namespace fluidcarve
