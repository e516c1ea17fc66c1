#pragma once

#include "carve/seam/seams.h"
#include "carve/time/frame_carve_promise.h"
#include "carve/volume/volume.h"
#include "formats/file/provenance.h"

#include <optional>
#include <string>

namespace fluidcarve {

/// Converts seams to the volume that a seam file holds. Each seam, in order, is a FloatGrid
/// `seam.0000`, and so on: its value at `(lateral, slice, t)`, or at `(i, j, k)` for seams of
/// frames, is the seam's entry, and all columns are active. Grid metadata: `kind` and `energy`.
/// Pairs have a second grid each, `seam.0000.pair`. A warp has the grids of grids_of_warp()
/// instead. Volume metadata: seam_texts() and, as `fluidcarve_checksum`, seam_checksum().
Volume seams_to_volume(const Seams& seams);

/// Converts such a volume back to seams, or a warp. Does not check that neighbouring entries are
/// feasible. Takes memory only for what the grids hold, whatever the metadata states.
/// @throws Failure (input), without the file's name, if anything is missing, not a whole number,
///   or out of range, or if there is a checksum and it does not match
Seams seams_from_volume(const Volume& volume);

/// Writes a seam file, whole or not at all.
/// @throws Failure if it can't be written
void write_seams(const std::string& path, const Seams& seams, const Provenance& provenance = {});
/// The effect of a file's seams on the frames of a sequence, by its header; nothing if they are
/// not seams of frames, or if the file can't be read.
std::optional<FrameCarvePromise> frames_carved_by(const std::string& path);
/// Reads a seam file.
/// @throws Failure (input) naming the file
Seams read_seams(const std::string& path);

}  // namespace fluidcarve
