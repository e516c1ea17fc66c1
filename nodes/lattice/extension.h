#pragma once

#include "nodes/lattice/folds.h"
#include "nodes/lattice/overlap.h"

#include <optional>

namespace fluidcarve {

/// What goes wrong with the cells by which insertions extend a lattice beyond its first or last vertices (METHOD 2): they fold, or
/// meet others, though the lattice itself does neither. Gathers over the frames.
class Extension {
public:
    /// @param axis          along which seams are inserted
    /// @param below, above  how many vertices they add before the first and beyond the last, at least 0
    void add(const Lattice& lattice, Axis axis, int below, int above, int frame);
    /// The worst of it in words, with its frame if there were lattices of several, or empty.
    std::string fault() const;

private:
    struct Worst {
        std::size_t count = 0;  ///< more than in the lattice itself
        int plane = 0, frame = 0;
    };
    std::string where(const Worst& worst) const;

    std::string hash_;  ///< of the lattice before
    bool moves_ = false;
    Axis axis_ = Axis::u;
    int below_ = 0, above_ = 0, planes_ = 0;
    Worst folds_, overlap_;
};

}  // namespace fluidcarve
