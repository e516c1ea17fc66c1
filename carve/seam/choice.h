#pragma once

#include "carve/base/values.h"
#include "carve/lattice/lattice.h"
#include "carve/seam/seams.h"
#include "carve/seam/similarity.h"
#include "carve/volume/volume.h"

#include <cstddef>
#include <vector>

namespace fluidcarve {

/// Chooses how many seams of a set look best if a warp does the rest (METHOD 11 "Seams or a
/// warp"). Compares some numbers of seams in some planes of each frame; even scaling stands for
/// the warp. Doubled slabs get at most a third of the lattice's vertices: more would show repeats
/// side by side.
class SeamChoice {
public:
    /// @param seams  thin or thick, not in pairs, no warp
    explicit SeamChoice(Ref<Seams> seams);

    /// Adds one frame.
    /// @param field  the field that people look at
    void add(const Lattice& lattice, const FloatGrid& field, int frame);

    /// The compared numbers of seams, rising from 0.
    const std::vector<std::size_t>& counts() const { return counts_; }
    /// Distance from the input for each of counts(), as a multiple of that of even scaling alone.
    std::vector<double> distances() const;
    /// The number whose distance is least.
    std::size_t best() const;

private:
    /// Patch distances for one number of seams: from result to input, and from input to result.
    struct Distances {
        PatchSum of_result, of_input;
        double sum() const { return of_result.root_mean() + of_input.root_mean(); }
    };

    Ref<Seams> seams_;
    std::vector<std::size_t> counts_;
    std::vector<Distances> distances_;  ///< of each of the counts
};

}  // namespace fluidcarve
