#pragma once

#include "graph/types/node_type.h"
#include "nodes/seam/search/find_seams.h"

#include <cstdint>
#include <vector>

namespace fluidcarve {

/// How much work is spent on a seam.
enum class Quality { draft, normal, best };

/// Finds seams from coarse to fine (METHOD 8). Images and small energies are solved exactly. Others are first solved at half, a quarter,
/// ... of the resolution. The coarsest is cut as a whole (exactly, except with a field). From there each finer one is solved in narrow
/// bands around the coarser seam, by line sweeps (search/line_sweeps.h) and minimum cuts (cut/cut_seam.h). Never worse than seam.greedy: the greedy seam
/// competes with the coarse one.
class Pyramid {
public:
    /// @param starts  number of greedy searches
    Pyramid(Quality quality, int starts) : quality_(quality), starts_(starts) {}

    /// A FindSeam.
    Seams::Seam operator()(const EnergyVolume& energy, Window window, int number, const Tick& tick) const;

private:
    /// @param large  whether the finest energy has more columns than are cut
    std::vector<std::uint16_t> coarse_to_fine(const EnergyVolume& energy, Window window, int number, bool large, const std::function<void()>& tick) const;
    /// Improves a seam within narrow bands around it.
    /// @param large  as for coarse_to_fine()
    void refine(const EnergyVolume& energy, Window window, int number, bool large, std::vector<std::uint16_t>& seam, const std::function<void()>& tick) const;

    Quality quality_;
    int starts_;
};

/// `seam.pyramid`: the node of Pyramid.
NodeType seam_pyramid();

}  // namespace fluidcarve
