#pragma once

#include "carve/base/values.h"
#include "carve/lattice/lattice.h"
#include "carve/seam/carve_map.h"
#include "carve/seam/seams.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace fluidcarve {

/// The space in which seams are found: the lattices of a sequence, and what the seams and warps of
/// `after` leave of them. It refers to the lists passed to it.
class CarvedSpace {
public:
    /// @param lattices  `[t]`, of one shape; only the first if all frames share it together with
    ///   their energy
    /// @param after     in the order of carving
    /// @param frames    frame numbers
    /// @throws Failure as CarveMap, for the first frame
    CarvedSpace(const std::vector<Ref<Lattice>>& lattices, const std::vector<Ref<Seams>>& after,
                const std::vector<int>& frames);

    const std::vector<Ref<Lattice>>& lattices() const { return lattices_; }
    const std::vector<int>& frames() const { return frames_; }
    bool carved() const { return !after_.empty(); }
    /// I, J, K after the sets are carved.
    std::array<int, 3> shape() const;
    LatticeForm form() const;
    /// Index of the lattice and the energy of frame `t`: `t`, or 0 if all frames share one.
    std::size_t place(std::size_t t) const { return std::min(t, lattices_.size() - 1); }
    /// How the sets carve the lattice of frame `t`.
    /// @throws Failure as CarveMap
    CarveMap carve_map(std::size_t t) const;
    /// Faults of the cells by which insertions extend the lattices, in words; empty if there are
    /// none.
    /// @param found  a set carved after the others
    std::string extension_fault(const Seams& found) const;

private:
    const std::vector<Ref<Lattice>>& lattices_;
    const std::vector<Ref<Seams>>& after_;
    const std::vector<int>& frames_;
};

}  // namespace fluidcarve
