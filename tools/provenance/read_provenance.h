#pragma once

#include "formats/file/provenance.h"

#include <string>

namespace fluidcarve {

/// What a file states of how it was made; empty if it states nothing. Knows VDB, PNG, JPEG, EXR and
/// PLY files by their first bytes, and OBJ files by their ending.
/// @throws Failure (input) if the file can't be read, is damaged, or is of another kind
Provenance read_provenance(const std::string& path);

}  // namespace fluidcarve
