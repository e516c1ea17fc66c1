#pragma once

#include "graph/types/context.h"
#include "nodes/payloads.h"

#include <nlohmann/json_fwd.hpp>

namespace fluidcarve {

/// Section of the report with what a carve did to each grid in each frame, and section with what it did to each grid over all frames
/// (pipelines/FORMATS.md).
inline constexpr const char* grids_by_frame = "grids_by_frame";
inline constexpr const char* carved_grids = "grids";

/// Measures the float and double grids of a frame before and after a carve. The components of a velocity in three grids are left out.
/// @param after  the carved volume, with the grids of `before` in their order
/// @return the frame's entry for `grids_by_frame`
nlohmann::ordered_json compared(const Volume& before, const Volume& after);

/// Says what a carve did, from the entries of all frames: the node's entry for `grids`, a line for each grid, and warnings if a carve
/// changed nothing, left nothing, changed the mass by more than a third, or moved the place where the content starts by 10 voxels or more.
/// @param frames  entries of compared() by frame number, or a single one of any other name
void tell_result(const nlohmann::ordered_json& frames, Context& context);

}  // namespace fluidcarve
