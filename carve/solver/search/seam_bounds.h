#pragma once

#include "carve/base/tick.h"
#include "carve/seam/seams.h"
#include "carve/seam/window.h"
#include "carve/solver/costs/energy_volume.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace fluidcarve {

/// A seam that is known up to a frame.
struct SeamStart {
    std::size_t frame;
    double before, with_frame;     ///< costs of the frames before `frame`, and of these and
                                   ///< `frame`
    const std::uint16_t* entries;  ///< in the frame's columns
    std::size_t stride;            ///< from a column's entry to the next column's
};

/// Lower bounds for consecutive seams (METHOD 8 "A certificate"). A search may use its seam's
/// bound to give up candidates that can't win.
class SeamBounds {
public:
    SeamBounds() = default;
    SeamBounds(const SeamBounds&) = delete;
    SeamBounds& operator=(const SeamBounds&) = delete;
    virtual ~SeamBounds() = default;

    /// Finds the bound on the cost of any seam in the window, if it is not yet known. It takes
    /// about as long as a search, and may run in parallel.
    /// @param number  of seams found before
    /// @return whether there is a bound; none is computed if it would take too long
    virtual bool find(const EnergyVolume& energy, Window window, int number, const Tick& tick) = 0;
    /// Lower bound on the cost of any seam with this start, in the energy of the last find(),
    /// which must have returned true. Any thread may call this.
    virtual double with(const SeamStart& start) const = 0;
    /// Lower bound on the energy of any seam, given a seam already found; nothing if none is
    /// computed.
    virtual std::optional<double> energy_bound(const EnergyVolume& energy, Window window,
                                               std::span<const std::uint16_t> found, int number,
                                               const Tick& tick) = 0;
    /// Follows a seam that is about to be deleted from the energy, just found or known before.
    /// @param window  the part of it that earlier seams left
    /// @param at      its entry in each column of the energy
    virtual void follow(const EnergyVolume& energy, Window window,
                        std::span<const std::uint16_t> at, int number) = 0;
};

}  // namespace fluidcarve
