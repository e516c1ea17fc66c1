#pragma once

#include "formats/file/input_file.h"
#include "formats/file/provenance.h"

#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// The beginning of a comment; `# ` in OBJ and USD files.
inline constexpr std::string_view hash_comment = "# ", ply_comment = "comment ";

/// A comment line for each entry, without line ends. @param begin  the beginning of a comment
std::vector<std::string> provenance_comments(const Provenance& provenance, std::string_view begin);

/// Whether a line of an OBJ or USD file or of a PLY header is such a comment.
bool is_provenance_comment(std::string_view line);

/// The provenance in the comments that an OBJ or USD file begins with, or in a PLY header.
/// @throws Unreadable
Provenance provenance_of_comments(const InputFile& file);

}  // namespace fluidcarve
