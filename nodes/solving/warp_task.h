#pragma once

#include "carve/seam/seams.h"
#include "carve/solver/task/params.h"
#include "carve/solver/task/space.h"
#include "carve/warp/find_warp.h"
#include "nodes/params/warp_params.h"

#include <cstddef>

namespace fluidcarve {

/// Amounts are multiples of this, so that one kept solution gives the same warp for each.
constexpr double warp_amount_step = 1.0 / 65536;
/// The nearest multiple of warp_amount_step.
double in_steps(double amount);

/// Whether the amount is 0, as far as known without reading a file.
bool states_nothing(const WarpParams& params);

/// Parameters that make GatheredEnergy gather energies as for solvers of seams.
SolverParams gathering_params(const WarpParams& params);

/// An empty set, for a warp that is yet to be found.
Seams empty_warp(const WarpParams& params, const CarvedSpace& space);

/// Vertices from point to point: as few as time allows. Depends on the size of the set alone, so
/// that a warp does not depend on the memory; larger warps are held in files.
int warp_factor_for(const WarpParams& params, const Seams& set, std::size_t frames);

/// The task of a warp of a set.
WarpTask warp_task(const WarpParams& params, const WarpAmount& amount, const Seams& set,
                   const Warp& warp);

}  // namespace fluidcarve
