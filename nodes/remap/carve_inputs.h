#pragma once

#include "graph/types/context.h"
#include "graph/types/param.h"
#include "nodes/seams/carve_map.h"

namespace fluidcarve {

/// The map of a node that carves by the inputs `lattice` and `seams` and the parameter `count`, in the context's frame.
/// @param count  seams of the last set, its sign may be left out; auto is all
/// @throws Failure as CarveMap; if the softness is wider than the lattice; if `count` removes and the seams insert; if the
///   node runs once for all frames, but the seams change from frame to frame
CarveMap carve_map(const Lattice& lattice, const std::vector<std::shared_ptr<const Seams>>& seams, const Auto<Count>& count, const Context& context,
                   const Softness& softness = {});
/// The same in any frame, whatever the others are like.
CarveMap carve_map(const Lattice& lattice, const std::vector<std::shared_ptr<const Seams>>& seams, const Auto<Count>& count, int frame,
                   const Softness& softness = {});

}  // namespace fluidcarve
