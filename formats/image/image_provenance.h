#pragma once

#include "formats/file/input_file.h"
#include "formats/file/provenance.h"

#include <string>

namespace fluidcarve {

/// Adds provenance to a finished PNG file, as `tEXt` chunks before the picture, or to a JPEG file,
/// as APP9 segments that begin with `fluidcarve` and a 0. The file must not have provenance yet.
/// Leaves other files as they are.
void add_provenance(const std::string& path, const Provenance& provenance);

/// The provenance in a PNG, JPEG or EXR file; empty for other files.
/// @throws Failure (input) if the file is damaged where provenance may stand
Provenance provenance_of_image(const InputFile& file);

}  // namespace fluidcarve
