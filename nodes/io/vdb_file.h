#pragma once

#include "nodes/io/origin.h"
#include "nodes/payloads.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace fluidcarve {

/// What a .vdb file says of its grids before one of them is read.
struct VdbHeader {
    struct Entry {
        std::string unique_name;                       ///< with the number that tells grids of one name apart: "density[1]"
        std::string name;                              ///< without it
        std::string type;                              ///< OpenVDB's name of the grid type: "Tree_float_5_4_3"
        openvdb::math::Transform::ConstPtr transform;  ///< null in files so old that it stands behind the tree
        openvdb::MetaMap metadata;
        std::string codec;  ///< as Volume::codec
    };
    std::string path;
    unsigned version = 0;       ///< of the file format
    openvdb::MetaMap metadata;  ///< the file's own
    std::vector<Entry> grids;   ///< in file order

    /// Where in `grids` the first of this name is or, if there is none, that of this unique name.
    /// @throws Failure (input) listing the grids
    std::size_t place(const std::string& name) const;
    /// Unique names, in file order.
    std::vector<std::string> names() const;
};

/// Walks the header. OpenVDB reads a truncated file without an error, so this is the check that the file is whole.
/// @throws Failure (input) if the file is missing, unreadable, no VDB, truncated, or too new for the library
VdbHeader read_vdb_header(const std::string& path);

/// All grids, in the order of VdbHeader::grids, loaded at once (nothing is left to load later, from many threads).
/// Shared trees stay shared; half floats are widened and the grid's half flag is set. A grid of a type that OpenVDB doesn't
/// know is a RawGrid.
/// @throws Failure (input) as read_vdb_header, or naming the grid that can't be read
Volume read_vdb(const std::string& path);

/// One grid, found as VdbHeader::place does; no other is read.
/// @throws Failure (input) as those two
openvdb::GridBase::Ptr read_vdb_grid(const std::string& path, const std::string& name);

/// How the bytes of a file are compressed. None of these loses anything.
enum class Codec {
    as_read,  ///< as the volume's file was; blosc if it came from none
    blosc,
    zip,  ///< OpenVDB leaves level sets and fog volumes unzipped
    none,
};

/// Writes aside, reads the header back (OpenVDB does not notice a full disk), then renames: the file appears whole or not at all.
/// Everything but the writer's own statistics (metadata `file_*`) reads back as it was. Grids go back to where and what
/// they were in their file (origin.h): placements are undone, triplets are three grids again.
/// @param placement  what to undo instead, in all grids; null: what the reader of each did
/// @throws Failure if the file can't be written or did not come out whole, or a RawGrid does not fit the codec
void write_vdb(const std::string& path, const Volume& volume, Codec codec = Codec::as_read, const Placement* placement = nullptr);

}  // namespace fluidcarve
