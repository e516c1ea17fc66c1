#pragma once

#include "carve/seam/seams.h"
#include "carve/seam/window.h"
#include "carve/solver/costs/volume.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

namespace fluidcarve {

/// Takes the progress of the work, 0 to 1. Called a few times a second, from several threads at
/// once; stops the work by throwing.
using Tick = std::function<void(double fraction)>;

/// A seam that is known up to a frame.
struct SeamStart {
    std::size_t frame;
    double before, with_frame;     ///< costs of the frames before, and of these and the frame
    const std::uint16_t* entries;  ///< in the frame's columns
    std::size_t step;              ///< from the entry in a column to that in the next
};

/// Lower bounds for seams that are found one after the other (METHOD 8 "A certificate"). A search
/// may use the one for its seam to give up ways that can't win.
class SeamBounds {
public:
    SeamBounds() = default;
    SeamBounds(const SeamBounds&) = delete;
    SeamBounds& operator=(const SeamBounds&) = delete;
    virtual ~SeamBounds() = default;

    /// Finds the bound on the cost of any seam in the window, unless that is done. It takes about
    /// as long as a search, and may run beside it.
    /// @param number  of seams found before
    /// @return whether there is one; none is sought if it would take too long
    virtual bool find(const EnergyVolume& energy, Window window, int number, const Tick& tick) = 0;
    /// Lower bound on the cost of any seam that begins so, in the energy of the last find(), which
    /// found one. Any thread may call this.
    virtual double with(const SeamStart& start) const = 0;
    /// Lower bound on the energy of any seam, in the place of a seam that was found; nothing if
    /// none is sought.
    virtual std::optional<double> energy_bound(const EnergyVolume& energy, Window window,
                                               std::span<const std::uint16_t> found, int number,
                                               const Tick& tick) = 0;
    /// Follows a seam that is about to be deleted from the energy, just found or known before.
    /// @param window  what earlier seams left of it
    /// @param at      its entry in each column of the energy
    virtual void follow(const EnergyVolume& energy, Window window,
                        std::span<const std::uint16_t> at, int number) = 0;
};

}  // namespace fluidcarve
