#pragma once

#include <openvdb/Types.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// Whole numbers with and without a sign, and floats, of the sizes that PLY has.
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t size_of(PlyType type);

enum class PlyEncoding { ascii, little, big };

/// The vertices of a PLY file, column by column, in the file's order and space.
struct PlyPoints {
    struct Column {
        std::string name;       ///< "x", "red"
        std::string type_name;  ///< as the file spells it: "float" or "float32"
        PlyType type = PlyType::float32;
        std::vector<char> values;  ///< of this machine's byte order
    };
    PlyEncoding encoding = PlyEncoding::little;
    std::vector<std::string> comments;        ///< lines of the header, `comment` or `obj_info` included
    std::vector<std::string> empty_elements;  ///< lines of the header that declare elements of which the file has none
    std::vector<Column> columns;
    std::size_t size = 0;  ///< of each column

    /// Null if there is none of that name.
    const Column* column(std::string_view name) const;
    /// A value as a double; of another type than float64 nothing is lost.
    static double number(const Column& column, std::size_t row);
    /// The value nearest to a number.
    static void set(Column& column, std::size_t row, double value);

    openvdb::Vec3d position(std::size_t row) const;
    void set_position(std::size_t row, const openvdb::Vec3d& to);
    std::size_t bytes() const;
};

/// Whether a file starts as PLY files do.
bool is_ply(const std::string& path);

/// @throws Failure (input) naming the file and what is wrong: no PLY, cut off, no x, y and z of floats, a position that is not
///   finite, lists at vertices, or other elements, such as faces, that would lose their vertices
PlyPoints read_ply(const std::string& path);

/// The same from the header alone; the columns stay empty. That the file holds what it states is checked as far as its length says.
PlyPoints read_ply_header(const std::string& path);

/// Writes aside and renames: the file appears whole or not at all. Numbers of ascii files are as short as gives them back.
/// @throws Failure if the file can't be written
void write_ply(const std::string& path, const PlyPoints& points);

}  // namespace fluidcarve
