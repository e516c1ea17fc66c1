#pragma once

#include "nodes/geometry_file/ply.h"

#include <openvdb/Types.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// The vertices of a PLY file, column by column, in the file's order and space.
struct PlyPoints {
    struct Column {
        std::string name;       ///< "x", "red"
        std::string type_name;  ///< name in the file: "float" or "float32"
        PlyType type = PlyType::float32;
        std::vector<char> values;  ///< bytes of one value per vertex, in this machine's byte order
    };
    PlyEncoding encoding = PlyEncoding::little;
    std::vector<std::string> comments;        ///< whole header lines that begin with `comment` or `obj_info`
    std::vector<std::string> empty_elements;  ///< header lines that declare elements without entries
    std::vector<Column> columns;
    std::size_t size = 0;  ///< number of vertices

    /// The column of this name, or null.
    const Column* column(std::string_view name) const;
    /// A value as a double; exact for all types.
    static double number(const Column& column, std::size_t row);
    /// Sets a value to the nearest that its type holds.
    static void set(Column& column, std::size_t row, double value);

    openvdb::Vec3d position(std::size_t row) const;
    void set_position(std::size_t row, const openvdb::Vec3d& to);
    std::size_t bytes() const;
};

/// Whether a file begins like a PLY file. @throws Failure (input) if it can't be read
bool is_ply(const std::string& path);

/// Whether the header of a PLY file declares vertices alone, as read_ply takes them: no faces.
bool holds_points(const std::string& path);

/// Reads a PLY file.
/// @throws Failure (input) naming the file and the fault: not a PLY file, truncated, no x, y and z of floats, a position that is not
///   finite, lists at vertices, or other elements with entries, such as faces, which refer to vertices
PlyPoints read_ply(const std::string& path);

/// Reads only the header; the columns stay empty. Checks the file's length. @throws Failure as read_ply, for the header
PlyPoints read_ply_header(const std::string& path);

/// Writes a PLY file. It appears whole or not at all. Numbers in ascii files are the shortest that read back exactly.
/// @throws Failure if the file can't be written
void write_ply(const std::string& path, const PlyPoints& points);

}  // namespace fluidcarve
