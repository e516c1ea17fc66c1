#pragma once

#include "graph/pipeline.h"
#include "tools/draft/request.h"

namespace fluidcarve {

/// The fields of a preview.sheet, without its path, of the first grids that a pipeline carves:
/// before and after. None if it carves no grids.
DraftRequest::Fields draft_preview(const Pipeline& pipeline);

}  // namespace fluidcarve
