#pragma once

#include "carve/base/values.h"
#include "carve/lattice/lattice.h"
#include "carve/seam/anchor.h"
#include "carve/seam/vertex_range.h"
#include "carve/solver/costs/sample.h"

#include <array>
#include <cstddef>
#include <utility>

namespace fluidcarve {

template <>
struct ChoiceNames<Axis> {
    static constexpr std::array names = {std::pair{"u", Axis::u}, std::pair{"v", Axis::v},
                                         std::pair{"w", Axis::w}, std::pair{"t", Axis::t}};
};

template <>
struct ChoiceNames<Measure> {
    static constexpr std::array names = {std::pair{"vertex", Measure::vertex},
                                         std::pair{"volume", Measure::volume}};
};

/// What a seam pays for.
enum class CostMode {
    backward,  ///< the energy that it removes
    forward,   ///< also the edges that it leaves behind
};

template <>
struct ChoiceNames<CostMode> {
    static constexpr std::array names = {std::pair{"backward", CostMode::backward},
                                         std::pair{"forward", CostMode::forward}};
};

/// The parameters of a solver (meanings: pipelines/NODES.md).
struct SolverParams {
    Axis axis = Axis::u;
    Count count;
    Auto<VertexRange> window;
    Auto<VertexRange> pair_window;
    bool static_ = false;
    bool pair_static = false;
    bool best_effort = false;
    Measure measure = Measure::vertex;
    Auto<int> thickness = 1;
    Auto<CostMode> cost;
    float field_weight = 1;
    Auto<float> empty;
    Auto<float> rigidity;
    Auto<float> rigidity_time;
    Auto<int> spread;
    Anchor anchor;
    Auto<int> bound_passes;
    Auto<int> finest;
};

/// Sets the defaults that depend on whether frames have a field. With a field, seams of frames
/// spare the first and the last frame, unless a window is stated: end frames make no edge, so
/// seams would crop the shot, or begin it with a halt.
SolverParams params_for(const SolverParams& stated, bool has_field, std::size_t frames);

/// The parameter `finest`, or its value for a lattice if it is `auto`. It depends on the lattice
/// alone, so that all machines and all parts of a sequence agree.
/// @return 1 or 2
int finest_for(const SolverParams& params, const Lattice& lattice);

}  // namespace fluidcarve
