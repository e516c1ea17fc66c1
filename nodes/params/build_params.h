#pragma once

#include "carve/lattice/content_reach.h"
#include "carve/lattice/rig_extent.h"
#include "nodes/params/lattice_node.h"
#include "nodes/params/param_forms.h"

#include <array>
#include <utility>

namespace fluidcarve {

/// How a lattice locates positions.
enum class Inverse { exact, closed_form };

template <>
struct ChoiceNames<Inverse> {
    static constexpr std::array names = {std::pair{"exact", Inverse::exact},
                                         std::pair{"closed_form", Inverse::closed_form}};
};

/// The parameters of `lattice.build`. Its declaration says what each means.
struct BuildParams : LatticeNode::Params {
    Auto<double> spacing;
    RigExtent extent_u, extent_v;
    bool flip_u = false;
    Inverse mapping = Inverse::exact;
};

/// Finds parameters that do not go together, or with the input `content`.
void check_params(const BuildParams& params, NodeCheck& check);

/// Requires that extents hold as many vertices as a lattice may have.
/// @param content  how wide the content is
void require_extents(const BuildParams& params, const ContentReach& content, double spacing);

/// The lattice to build. @param content  how wide the content is
LatticeSpec spec_of(const BuildParams& params, const ContentReach& content, double spacing);

}  // namespace fluidcarve
