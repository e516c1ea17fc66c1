#pragma once

#include "nodes/payloads.h"
#include "nodes/seams/seams.h"

#include <string>

namespace fluidcarve {

/// Seams as a volume (the contract's "Seam file"): for each seam in order a FloatGrid `seam.0000`, whose value at
/// `(lateral, k, t)` is its entry, all columns active, with metadata `kind` and `energy`, and of pairs a second one,
/// `seam.0000.pair`; the volume's metadata say axis, shape, frames and lattice, and `fluidcarve_closed` if that is closed.
Volume seams_to_volume(const Seams& seams);

/// The reverse. Feasibility is not asked for.
/// @throws Failure (input), without the file's name, if anything is missing, or no whole number, or out of range
Seams seams_from_volume(const Volume& volume);

/// Writes a seam file; it appears whole or not at all. @throws Failure
void write_seams(const std::string& path, const Seams& seams);
/// @throws Failure (input) naming the file
Seams read_seams(const std::string& path);

}  // namespace fluidcarve
