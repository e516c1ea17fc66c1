#pragma once

#include "carve/volume/stored_form.h"
#include "carve/volume/volume.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// The header of a .vdb file: all grids without their trees.
struct VdbHeader {
    struct Entry {
        std::string unique_name;  ///< name with an index if several grids have it: "density[1]"
        std::string name;         ///< name without the index
        std::string type;         ///< OpenVDB's type name: "Tree_float_5_4_3"
        /// Null in old files, where it comes after the tree.
        openvdb::math::Transform::ConstPtr transform;
        openvdb::MetaMap metadata;
        std::string codec;  ///< as Volume::codec
    };
    std::string path;
    unsigned version = 0;       ///< version of the file format
    openvdb::MetaMap metadata;  ///< metadata of the file
    std::vector<Entry> grids;   ///< in file order

    /// Index in `grids` of the first grid with this name, else of the grid with this unique name;
    /// nothing if there is none.
    std::optional<std::size_t> find(const std::string& name) const;
    /// The same. @throws Failure (input) listing the grids, if there is none
    std::size_t place(const std::string& name) const;
    /// Unique names, in file order.
    std::vector<std::string> names() const;
};

/// Memory that a grid takes, counted from its tree's topology in the file.
struct GridMemory {
    std::uint64_t tree = 0;   ///< bytes, without points
    std::uint64_t dense = 0;  ///< bytes of the values of all active voxels, including those of
                              ///< tiles
};

/// An open .vdb file. Its header is parsed only once.
class VdbFile {
public:
    /// Opens the file and checks that it is complete; OpenVDB reads a truncated file without an
    /// error.
    /// @param budget  memory that a grid's tree may take, as in grid_fits
    /// @throws Failure (input) if the file is missing, unreadable, not a VDB file, truncated, or
    ///   too new for the library
    explicit VdbFile(const std::string& path, std::uint64_t budget = ~std::uint64_t{0});
    ~VdbFile();

    /// The header, read at the first call.
    /// @throws Failure (input) if the metadata or transform of a grid is damaged
    const VdbHeader& header();
    /// Reads all grids, in the order of VdbHeader::grids, without delayed loading. Shared trees
    /// stay shared. Half floats become floats, and the grid's half flag is set. A grid of an
    /// unknown type becomes a RawGrid.
    /// @throws Failure (input) naming the grid that can't be read, or takes too much memory
    Volume read();
    /// Reads one grid only.
    /// @param place  index in VdbHeader::grids
    /// @throws Failure (input) as read()
    openvdb::GridBase::Ptr read(std::size_t place);
    /// Counts the memory that a grid takes.
    /// @return nothing if its topology is larger than 256 KiB, or can't be counted
    std::optional<GridMemory> memory(std::size_t place);

private:
    class Stream;
    std::unique_ptr<Stream> stream_;
    std::optional<VdbHeader> header_;
};

/// VdbFile::header of a file.
VdbHeader read_vdb_header(const std::string& path);
/// VdbFile::read of a file.
Volume read_vdb(const std::string& path);

/// Compression of a file. All are lossless.
enum class Codec {
    as_read,  ///< that of the volume's file; blosc if it has none
    blosc,
    zip,  ///< OpenVDB does not compress level sets and fog volumes with zip
    none,
};

/// Writes a volume. The file appears whole or not at all; its header is read back before, since
/// OpenVDB does not notice a full disk. Everything but the writer's own statistics (metadata
/// `file_*`) reads back as it was. Grids are written as they were in their file (stored_form.h):
/// placements are undone, merged triplets become three grids.
/// @param placement  the placement to undo in all grids; null: that of each grid's reader
/// @return the header, as it was read back
/// @throws Failure if the file can't be written or is not complete, or a RawGrid does not fit the
///   codec
VdbHeader write_vdb(const std::string& path, const Volume& volume, Codec codec = Codec::as_read,
                    const Placement* placement = nullptr);

}  // namespace fluidcarve
