#pragma once

#include "carve/base/values.h"
#include "carve/lattice/lattice.h"
#include "carve/seam/seams.h"
#include "carve/seam/similarity.h"
#include "carve/volume/volume.h"

#include <cstddef>
#include <vector>

namespace fluidcarve {

/// How many seams of a set look best together with a warp of the rest (METHOD 11 "Seams or a
/// warp"). Some numbers of seams are compared, in some planes of some frames, with even scaling in
/// place of the warp. Of slabs that are doubled, it takes at most what a third of the lattice's
/// vertices holds: more repeats would stand side by side.
class SeamChoice {
public:
    /// @param seams  thin or thick, not in pairs, no warp
    explicit SeamChoice(Ref<Seams> seams);

    /// Adds what one frame shows.
    /// @param field  that is seen
    void add(const Lattice& lattice, const FloatGrid& field, int frame);

    /// The numbers that are compared, from 0 on, rising.
    const std::vector<std::size_t>& counts() const { return counts_; }
    /// Distance from the input for each of them; of even scaling alone, it is 1.
    std::vector<double> distances() const;
    /// The number whose distance is least.
    std::size_t best() const;

private:
    /// What is compared of one number of seams: each patch of the result with the input, and the
    /// other way round.
    struct Distances {
        PatchSum of_result, of_input;
        double sum() const { return of_result.root_mean() + of_input.root_mean(); }
    };

    Ref<Seams> seams_;
    std::vector<std::size_t> counts_;
    std::vector<Distances> distances_;  ///< of each of the counts
};

}  // namespace fluidcarve
