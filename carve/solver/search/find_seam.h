#pragma once

#include "carve/seam/seams.h"
#include "carve/seam/window.h"
#include "carve/solver/costs/energy_volume.h"
#include "carve/solver/search/seam_bounds.h"

#include <functional>
#include <type_traits>
#include <utility>

namespace fluidcarve {

/// A solver: finds one seam in a window that holds at least one. It works on the present energy,
/// codes or sums. The seam is feasible, passes no protected vertex, and comes with its energy, in
/// which attracted vertices count 0. A solver that uses bounds takes them as a fifth argument,
/// `SeamBounds*`; null: there are none. Its third argument is the number of seams found before:
/// ties lean to one side for even numbers, to the other for odd ones.
class FindSeam {
public:
    template <class Find>
    requires(!std::is_same_v<std::remove_cvref_t<Find>, FindSeam>) FindSeam(Find find) {
        if constexpr (std::is_invocable_v<Find&, const EnergyVolume&, Window, int, const Tick&,
                                          SeamBounds*>)
            find_ = std::move(find);
        else
            find_ = [find = std::move(find)](const EnergyVolume& energy, Window window, int number,
                                             const Tick& tick, SeamBounds* /*bounds*/) mutable {
                return find(energy, window, number, tick);
            };
    }
    Seams::Seam operator()(const EnergyVolume& energy, Window window, int number, const Tick& tick,
                           SeamBounds* bounds = nullptr) const {
        return find_(energy, window, number, tick, bounds);
    }

private:
    std::function<Seams::Seam(const EnergyVolume& energy, Window window, int number,
                              const Tick& tick, SeamBounds* bounds)>
        find_;
};

}  // namespace fluidcarve
