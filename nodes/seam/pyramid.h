#pragma once

#include "graph/types/node_type.h"
#include "nodes/seam/search/find_seams.h"

#include <cstdint>
#include <span>
#include <vector>

namespace fluidcarve {

enum class Quality { draft, normal, best };

/// Seams from coarse to fine (METHOD 8): exact in images and where the energy is small, else in energies of half, a quarter, ... of the
/// resolution first, the coarsest as a whole (exactly, but for energies with a field), and from there in narrow bands around what the next coarser one gave, by
/// line sweeps (strip.h) and minimum cuts (cut_seam.h). Never worse than seam.greedy, whose seam starts beside the coarse one.
class Pyramid {
public:
    /// @param starts  of the greedy search
    Pyramid(Quality quality, int starts) : quality_(quality), starts_(starts) {}

    /// A FindSeam. Seams of one set are to be asked for in their order: each starts from the last.
    Seams::Seam operator()(const EnergyVolume& energy, Window window, int number, const Tick& tick);
    /// The last seam, where others were found before (Continued).
    void start_from(std::span<const std::uint16_t> last) { last_.assign(last.begin(), last.end()); }

private:
    std::vector<std::uint16_t> coarse_to_fine(const EnergyVolume& energy, Window window, int number, const std::function<void()>& tick) const;
    /// Along bands around a seam, in which it comes to lie anew.
    void refine(const EnergyVolume& energy, Window window, int number, std::vector<std::uint16_t>& seam, const std::function<void()>& tick) const;

    Quality quality_;
    int starts_;
    std::vector<std::uint16_t> last_;  ///< the seam before, if there is one
};

/// `seam.pyramid`: Pyramid as a node.
NodeType seam_pyramid();

}  // namespace fluidcarve
