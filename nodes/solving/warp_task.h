#pragma once

#include "carve/seam/seams.h"
#include "carve/solver/task/params.h"
#include "carve/solver/task/space.h"
#include "carve/warp/find_warp.h"
#include "nodes/params/warp_params.h"

#include <cstddef>

namespace fluidcarve {

/// Amounts are multiples of this, so that one kept solution answers each of them alike.
constexpr double warp_amount_step = 1.0 / 65536;
double in_steps(double amount);

/// Whether it is known without a look into a file that nothing is to be done.
bool states_nothing(const WarpParams& params);

/// The base of what is gathered: energies as the solvers of seams take them.
SolverParams gathering_params(const WarpParams& params);

/// A set in which a warp is to be found.
Seams empty_warp(const WarpParams& params, const CarvedSpace& space);

/// Vertices from point to point: as few as there is time for. It goes by the size of the set
/// alone, so that a warp is the same whatever the memory; what has no room there is in files.
int warp_factor_for(const WarpParams& params, const Seams& set, std::size_t frames);

/// What a warp of a set is to do.
WarpTask warp_task(const WarpParams& params, const WarpAmount& amount, const Seams& set,
                   const Warp& warp);

}  // namespace fluidcarve
