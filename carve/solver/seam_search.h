#pragma once

#include "carve/base/limits.h"
#include "carve/base/values.h"
#include "carve/lattice/lattice.h"
#include "carve/seam/seams.h"
#include "carve/solver/search/seam_bounds.h"
#include "carve/solver/task/gathered_energy.h"
#include "carve/solver/task/params.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <utility>
#include <vector>

namespace fluidcarve {

/// Finds the seams of a sequence whose frames are added one by one (METHOD 8), as `seam.pyramid`
/// does in a pipeline. It keeps each frame's energy and field at the lattice's vertices, two bytes
/// each.
class SeamSearch {
public:
    /// @param frames  their numbers, rising, at least one
    SeamSearch(SolverParams params, std::vector<int> frames, Limits limits = {})
        : params_(std::move(params)), frames_(std::move(frames)), limits_(std::move(limits)) {}

    /// Adds the next frame. All frames have one lattice, or each its own of the same shape.
    /// @param grids  energy >= 0; optionally field and masks; thick seams need the field
    /// @throws Failure as sample_frame() and GatheredEnergy::add()
    void add(const Ref<Lattice>& lattice, const FrameGrids& grids);

    /// Finds the seams. Call it once, after all frames are added.
    /// @param tick  is called a few times per second with the share that is done, 0 to 1; what it
    ///   throws ends the search
    /// @throws Failure as task_of() and GatheredEnergy::take_priced(), or if there is no room for
    ///   so many seams
    Ref<Seams> find(const Tick& tick = [](double) {});

private:
    SolverParams params_;
    std::vector<int> frames_;
    Limits limits_;
    std::size_t added_ = 0;
    GatheredEnergy gathered_;
};

}  // namespace fluidcarve
