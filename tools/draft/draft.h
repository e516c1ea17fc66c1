#pragma once

#include "tools/draft/request.h"

#include <string>

namespace fluidcarve {

struct Pipeline;

/// The text of a pipeline that carves a sequence in the box around it: smoke, fire, level sets,
/// particles, images or a mesh (contents_of). Its params are `sim`, `count` and its outputs.
/// Comments say what each node is for, and how the box becomes a lattice along a rig.
/// @throws Failure (input) if the files hold nothing that can be carved; Failure if they lack what
///   is to be protected
std::string draft_pipeline(const DraftRequest& request);

/// The fields of a preview.sheet, without its path, of the first grids that a pipeline carves:
/// before and after. None if it carves no grids.
DraftRequest::Fields draft_preview(const Pipeline& pipeline);

}  // namespace fluidcarve
