#pragma once

#include "carve/base/limits.h"
#include "carve/solver/search/seam_bounds.h"

#include <cstdint>
#include <memory>
#include <span>

namespace fluidcarve {

/// Lower bound on the energy of any seam in the window (METHOD 8 "A certificate"). Each column's
/// energies are divided among the lines of columns that cross there. Each line's part is solved
/// exactly, by dynamic programming, and the sum of the minima is a bound. Messages along the lines
/// determine the division. They begin with those of the energy at half the resolution
/// (restrict_energy()), and pass through one block of frames after the other. Rings of columns are
/// treated as open lines.
/// Messages take up to 400 MB, or what two frames need: 6 bytes per entry of the window; and at
/// half the resolution 6 bytes per entry, of all frames. The energy at half the resolution comes on
/// top.
/// If vertices are marked, this is a bound on the cost (EntryCosts); energy_bound() turns it into a
/// bound on the energy.
/// @param window  holds a seam
/// @param passes  passes to and fro after the first pass through each block, 0 or more;
///   they raise the bound
/// @param limits  of messages
/// @throws Failure as FrameStore
double lower_bound(const EnergyVolume& energy, Window window, int passes, const Tick& tick,
                   const Limits& limits = {});

/// lower_bound() for consecutive seams, each in the energy that the seams before it leave.
/// Messages are passed on from seam to seam, to and fro in turn, and follow the entries that seams
/// delete; any messages give a bound (METHOD 8 "A certificate"). They take 6 bytes per entry of
/// the window.
class ConsecutiveBounds {
public:
    /// Number of the first seam that shares messages with seam `number`.
    static int first_with(int number) { return number / seams_per_search * seams_per_search; }

    /// @param limits  as for lower_bound()
    explicit ConsecutiveBounds(Limits limits = {});
    ConsecutiveBounds(const ConsecutiveBounds&) = delete;
    ConsecutiveBounds& operator=(const ConsecutiveBounds&) = delete;
    ~ConsecutiveBounds();

    /// As lower_bound().
    /// @param window  loses its last entry with each seam
    /// @param number  of seams before
    double operator()(const EnergyVolume& energy, Window window, int number, int passes,
                      const Tick& tick);
    /// Lower bound on the cost of any seam with this start, in the energy of the last bound. Any
    /// thread may call this.
    double with(const SeamStart& start) const;
    /// Follows a seam that is deleted from the energy, if there are messages. Every later deletion
    /// must be reported, too.
    /// @param at  its entry in each column, `[t][column]`
    void follow(std::span<const std::uint16_t> at, int number);

private:
    static constexpr int seams_per_search = 16;

    struct Kept;
    std::unique_ptr<Kept> kept_;  ///< null: nothing yet
    Limits limits_;
};

}  // namespace fluidcarve
