#pragma once

#include "carve/remap/joining.h"
#include "carve/seam/carve_map.h"
#include "graph/types/context.h"
#include "graph/types/param.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace fluidcarve {

/// Why a part of a warp can't be carved.
extern const char* const part_of_warp;

/// Why inputs can't take seams of frames.
extern const char* const only_remapped;

/// The number of seams of the last set that a parameter `count` selects; nothing: all.
/// @throws Failure if it removes and the seams insert, or asks for a part of a warp
std::optional<std::size_t> seams_of(const Auto<Count>& asked, const Seams& last);

/// The carve map of a node with inputs `lattice` and `seams` and parameter `count`, in the
/// context's frame.
/// @param count  number of seams of the last set; its sign may be left out; auto: all
/// @throws Failure as CarveMap; as softness_of(); if `count` removes and the seams insert, or asks
///   for a part of a warp; if the node runs once for all frames, but the seams change from frame to
///   frame
CarveMap carve_map(const Lattice& lattice, const std::vector<Ref<Seams>>& seams,
                   const Auto<Count>& count, const Context& context,
                   const JoinParams& join = {Join::cut, {}, {}, 0});
/// The same in any given frame, for nodes that may carve a static source per frame: seams may
/// change from frame to frame.
CarveMap carve_map(const Lattice& lattice, const std::vector<Ref<Seams>>& seams,
                   const Auto<Count>& count, int frame,
                   const JoinParams& join = {Join::cut, {}, {}, 0});

}  // namespace fluidcarve
