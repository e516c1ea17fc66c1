#pragma once

#include "carve/lattice/folds.h"
#include "carve/lattice/overlap.h"

#include <cstddef>
#include <string>

namespace fluidcarve {

/// Collects, over the frames, faults of the cells that insertions add before the first or beyond
/// the last vertices of a lattice (METHOD 2): folds and overlaps that the lattice itself does not
/// have.
class ExtensionFaults {
public:
    /// Checks the lattice of a frame.
    /// @param axis          along which seams are inserted
    /// @param below, above  number of vertices added before the first and beyond the last, at
    ///   least 0
    /// @param frame         frame number
    void add(const Lattice& lattice, Axis axis, int below, int above, int frame);
    /// The worst fault in words, with its frame if the lattice moves; empty if there is none.
    std::string fault() const;

private:
    /// The worst of one kind of fault.
    struct Worst {
        /// Folded cells or shared voxels beyond those of the lattice itself.
        std::size_t count = 0;
        int plane = 0, frame = 0;
    };
    std::string where(const Worst& worst) const;

    std::string hash_;  ///< of the last lattice checked
    bool moves_ = false, around_ = false;
    Axis axis_ = Axis::u;
    int below_ = 0, above_ = 0, planes_ = 0;
    Worst folds_, overlap_;
};

}  // namespace fluidcarve
