#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace fuzz {

/// What a part of a VDB file says.
enum class Part {
    version,          ///< 32 bits
    grid_count,       ///< 32 bits
    type_name,        ///< a text behind its length
    parent_name,      ///< a text behind its length
    grid_position,    ///< 64 bits: where a grid, its leaves' values or its end are
    metadata_count,   ///< 32 bits
    metadata_length,  ///< 32 bits
    metadata_text,    ///< a text behind its length
    codec,            ///< 32 bits, OpenVDB's flags
    map_name,         ///< a text behind its length
    map_number,       ///< a double
    tile_count,       ///< 32 bits; the number of children follows, then the tiles
    child_count,      ///< 32 bits
    coordinate,       ///< 32 bits, of a tile or child of the root
    tile_state,       ///< a byte
    value,            ///< floats: a background or tile
    mask,             ///< of children or values
    node_kind,        ///< a byte that says how a node's values are stored
    chunk_length,     ///< 64 bits before values that are compressed
    chunk_header,     ///< 16 bytes: blosc's header
    point_number,     ///< 8 to 64 bits that describe attributes of points
    point_text,       ///< a text behind its length
};

struct Place {
    Part part;
    std::size_t at = 0;
    std::size_t size = 0;  ///< bytes; of texts, without the length before them
};

/// The places of a sound VDB file of version 222 or later: of its header, its grids' headers and
/// topologies, the attributes of points, and of all chunks that blosc compressed.
/// @throws std::out_of_range if the file is not sound
std::vector<Place> vdb_places(const std::string& file);

/// The file with bytes replaced, and the positions of its grids moved by as much.
/// @param places  those of `file`
std::string spliced(std::string file, const std::vector<Place>& places, std::size_t at,
                    std::size_t size, const std::string& bytes);

}  // namespace fuzz
