#pragma once

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace fluidcarve {

/// How OpenVDB stores the trees of one grid type in a file.
struct TreeFormat {
    enum class Leaves { values, bools, masks, point_data };
    Leaves leaves = Leaves::values;
    /// Bytes of a value in memory, and of backgrounds and root tiles in the file.
    std::size_t value_bytes = 0;
    /// Bytes of a value in a node; less than value_bytes for half floats.
    std::size_t stored_bytes = 0;
    std::uint32_t file_version = 0;  ///< of the file format
    std::uint32_t compression = 0;   ///< OpenVDB's flags
};

/// Whether both OpenVDB and check_tree() know the trees of a grid type. OpenVDB 10 cannot read the
/// point indices that it writes: they count as unknown.
/// @param type  as in a file: "Tree_float_5_4_3"
bool is_known_tree(const std::string& type);
/// @param type  must be known
/// @param half  whether floats are stored as half floats
TreeFormat tree_format(const std::string& type, bool half, std::uint32_t file_version,
                       std::uint32_t compression);

/// Size of a tree, counted without reading values.
struct TreeSize {
    std::uint64_t active_voxels = 0;  ///< including those of tiles
    std::uint64_t bytes = 0;          ///< memory of the tree, without points
};

/// The oldest file version that check_tree() knows: earlier files store the transform behind the
/// tree.
inline constexpr std::uint32_t oldest_file_version = openvdb::OPENVDB_FILE_VERSION_GRID_INSTANCING;

/// Counts what a tree's topology holds. @throws std::runtime_error as check_tree()
TreeSize size_of_tree(const TreeFormat& format, std::span<const char> topology);

/// Bytes of the parts of a tree in a file.
struct TreeLength {
    std::int64_t topology = 0, buffers = 0;
};

/// Finds where a tree ends.
/// @param bytes  the tree, and whatever follows it
/// @throws std::runtime_error as check_tree()
TreeLength length_of_tree(const TreeFormat& format, std::span<const char> bytes);

/// Checks all lengths, counts and offsets in the bytes of a tree before OpenVDB reads them, since
/// OpenVDB trusts them: a wrong length makes it write beyond its buffers. It follows OpenVDB's
/// readers byte by byte. Compressed data is checked by its header; blosc and zlib check the rest
/// themselves.
/// @param topology  bytes of the root, the internal nodes and the masks of the leaves
/// @param buffers   bytes of the leaves' values
/// @throws std::runtime_error saying what is wrong
TreeSize check_tree(const TreeFormat& format, std::span<const char> topology,
                    std::span<const char> buffers);
/// The same for a tree whose buffers follow its topology. Behind them, other bytes may follow.
TreeSize check_tree(const TreeFormat& format, std::span<const char> bytes);

}  // namespace fluidcarve
