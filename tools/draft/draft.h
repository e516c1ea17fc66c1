#pragma once

#include "tools/draft/request.h"

#include <string>

namespace fluidcarve {

/// The text of a pipeline that carves a sequence in the box around it: smoke, fire, level sets,
/// particles, images or a mesh (contents_of). Its params are `sim`, `count` and its outputs.
/// Comments say what each node is for, and how the box becomes a lattice along a rig.
/// @throws Failure (input) if the files hold nothing that can be carved; Failure if they lack what
///   is to be protected
std::string draft_pipeline(const DraftRequest& request);

}  // namespace fluidcarve
