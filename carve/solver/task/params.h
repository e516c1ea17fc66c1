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
enum class Cost {
    backward,  ///< the energy that it takes away
    forward,   ///< also the edges that it leaves behind
};

template <>
struct ChoiceNames<Cost> {
    static constexpr std::array names = {std::pair{"backward", Cost::backward},
                                         std::pair{"forward", Cost::forward}};
};

/// What is wanted of a solver (pipelines/NODES.md says what each means).
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
    Auto<Cost> cost;
    float field_weight = 1;
    Auto<float> empty;
    Auto<float> rigidity;
    Auto<float> rigidity_time;
    Auto<int> spread;
    Anchor anchor;
    Auto<int> bound_passes;
    Auto<int> finest;
};

/// The parameters of a search once it is known whether frames come with a field. Then seams of
/// frames leave the first and the last one, unless a window is stated: these make no edge, so that
/// a shot would be cropped, or begin with a halt.
SolverParams params_for(const SolverParams& stated, bool has_field, std::size_t frames);

/// The parameter `finest`, or what `auto` means for a lattice. It depends on nothing else, so that
/// all machines and all parts of a sequence agree.
/// @return 1 or 2
int finest_for(const SolverParams& params, const Lattice& lattice);

}  // namespace fluidcarve
