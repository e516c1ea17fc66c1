#pragma once

#include "carve/base/failure.h"
#include "carve/seam/seams.h"

#include <openvdb/MetaMap.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// The metadata of a seam file about its seams, as names and texts, in the order of the file's
/// documentation. Entries with default values are left out.
std::vector<std::pair<std::string, std::string>> seam_texts(const Seams& seams);

/// The number of vertices from point to point of the warp in a file; nothing if the file holds
/// seams.
/// @throws Failure (input) if it is none of 1, 2 and 4
std::optional<int> warp_factor(const openvdb::MetaMap& metadata);

/// Reads such metadata. Takes memory for no more frames than the shape states, and for no columns.
/// @return the seams without their entries, of unknown kind
/// @throws Failure (input), without the file's name, if a text is missing or wrong
Seams seams_of_texts(const openvdb::MetaMap& metadata);

/// A text in the metadata of a file or a grid.
/// @param owner  "the file", or the grid's name
/// @throws Failure (input) if there is none
std::string seam_text(const openvdb::MetaMap& metadata, const std::string& name,
                      const std::string& owner);

/// Whether values take little more memory than the grids of a file that hold them.
/// @param count       values in each grid
/// @param bytes_each  of a value in memory
/// @param held        bytes of all trees of the grids, each counted once
bool fits_grids(std::uint64_t count, std::size_t grids, std::size_t bytes_each, std::uint64_t held);

/// A failure that refuses a seam file.
Failure wrong_seams(const std::string& message);

}  // namespace fluidcarve
