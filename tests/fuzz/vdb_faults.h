#pragma once

#include "tests/fuzz/damage.h"
#include "tests/fuzz/vdb_places.h"

#include <string>
#include <vector>

namespace fuzz {

/// The file with one number, text or mask changed to what harms a reader that trusts it. All parts
/// are equally likely, however often they occur.
/// @param places  those of `file`
std::string faulty_vdb(const std::string& file, const std::vector<Place>& places, Random& random);

/// The same, for the texts of a seam file's metadata.
std::string faulty_seams(const std::string& file, const std::vector<Place>& places, Random& random);

/// The file with another text, and the length before it to match. @param place  of the text
std::string retold_at(const std::string& file, const std::vector<Place>& places, const Place& place,
                      const std::string& text);

/// The file with one more tile in a root, active.
/// @param tile_count  of that root, before which stands the background that the tile takes for its
///   value
std::string with_tile(const std::string& file, const std::vector<Place>& places,
                      const Place& tile_count, std::int32_t x, std::int32_t y, std::int32_t z);

}  // namespace fuzz
