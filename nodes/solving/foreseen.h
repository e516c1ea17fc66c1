#pragma once

#include "carve/base/values.h"
#include "carve/lattice/form.h"
#include "graph/types/outlook.h"
#include "graph/types/param.h"

namespace fluidcarve {

/// Warns, before a run, of an `energy` without voxels, and of a `lattice` that misses its voxels,
/// as far as the headers of files tell.
void warn_of_placement(Outlook& ahead);

/// States the form of the lattice that a node builds.
void deliver_form(const LatticeForm& form, Outlook& ahead);
/// The form of the input `lattice`, as deliver_form() stated it.
LatticeForm received_form(const Outlook& ahead);

/// States that a node finds a warp. @param still  whether the warp is the same in all frames
void deliver_warp(bool still, Outlook& ahead);
/// Whether any input `seams` is a warp, as deliver_warp() stated it.
bool receives_warp(const Outlook& ahead);
/// Adds the fault that a node can't carve a part of a warp. @param count  the node's parameter
void foresee_part(const Auto<Count>& count, Outlook& ahead);
/// The same, and adds a fault if a source is carved once for all frames by a warp that is not
/// still.
void foresee_carve(const Auto<Count>& count, Outlook& ahead);

}  // namespace fluidcarve
