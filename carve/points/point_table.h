#pragma once

#include "carve/base/numbers.h"

#include <openvdb/Types.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// The vertices of a PLY file, column by column, in the file's order and space.
struct PointTable {
    struct Column {
        std::string name;       ///< "x", "red"
        std::string type_name;  ///< name in the file: "float" or "float32"
        NumberType type = NumberType::float32;
        std::vector<char> values;  ///< bytes of one value per vertex, in this machine's byte order
    };
    NumberForm encoding = NumberForm::little;
    /// Whole header lines that begin with `comment` or `obj_info`
    std::vector<std::string> comments;
    /// Header lines that declare elements without entries.
    std::vector<std::string> empty_elements;
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

}  // namespace fluidcarve
