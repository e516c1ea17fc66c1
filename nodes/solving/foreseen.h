#pragma once

#include "carve/base/values.h"
#include "carve/lattice/form.h"
#include "graph/types/outlook.h"
#include "graph/types/param.h"

namespace fluidcarve {

/// Warns, before a run, of an `energy` without voxels, and of a `lattice` that misses them, as far
/// as the headers of files tell.
void warn_of_placement(Outlook& ahead);

/// Tells the form of the lattice that a node builds.
void tell_form(const LatticeForm& form, Outlook& ahead);
/// What is told of the form of the input `lattice`.
LatticeForm form_told(const Outlook& ahead);

/// Tells that a node finds a warp. @param still  whether it is the same in all frames
void tell_warp(bool still, Outlook& ahead);
/// Whether a warp is told to be among the input `seams`.
bool warp_told(const Outlook& ahead);
/// Says that a node can't carve a part of a warp. @param count  the node's parameter
void foresee_part(const Auto<Count>& count, Outlook& ahead);
/// The same, and that a source which is carved once for all frames needs a warp that is still.
void foresee_carve(const Auto<Count>& count, Outlook& ahead);

}  // namespace fluidcarve
