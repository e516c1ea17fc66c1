#pragma once

#include "carve/volume/volume.h"
#include "graph/types/context.h"

#include <nlohmann/json_fwd.hpp>

namespace fluidcarve {

/// Sections of the report with the effect of a carve on each grid: in each frame, and over all
/// frames (pipelines/FORMATS.md).
inline constexpr const char* grids_by_frame = "grids_by_frame";
inline constexpr const char* carved_grids = "grids";

/// Measures the float and double grids of a frame before and after a carve. The components of a
/// velocity in three grids are left out.
/// @param after  the carved volume, with the grids of `before` in their order
/// @return the frame's entry for `grids_by_frame`
nlohmann::ordered_json compared(const Volume& before, const Volume& after);

/// Reports the effect of a carve, from the entries of all frames: the node's entry for `grids`, a
/// line for each grid, and warnings if a carve changed nothing, left nothing, changed the mass by
/// a third or more though even scaling to the same size would not, or moved the source by 5 voxels
/// or more. The source is the end of the content that stands still over the sequence while the
/// other end moves.
/// @param frames  entries of compared() by frame number, or a single one of any other name
void report_result(const nlohmann::ordered_json& frames, Context& context);

}  // namespace fluidcarve
