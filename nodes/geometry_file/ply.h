#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// The number types of PLY.
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Bytes of a number in a binary file.
std::size_t size_of(PlyType type);
bool is_floating(PlyType type);
/// Name in a header, the older of two: "float", not "float32".
std::string_view name_of(PlyType type);

/// Calls `visit(T{})` with the C++ type.
template <class Visit>
auto with_ply_type(PlyType type, Visit&& visit) {
    switch (type) {
        case PlyType::int8: return visit(std::int8_t{});
        case PlyType::uint8: return visit(std::uint8_t{});
        case PlyType::int16: return visit(std::int16_t{});
        case PlyType::uint16: return visit(std::uint16_t{});
        case PlyType::int32: return visit(std::int32_t{});
        case PlyType::uint32: return visit(std::uint32_t{});
        case PlyType::float32: return visit(float{});
        case PlyType::float64: break;
    }
    return visit(double{});
}

/// A number as a double; exact for all types. @param swap  the bytes are in the order that this machine does not have
double ply_number(const char* bytes, PlyType type, bool swap);
/// Appends the bytes of a number. One outside the range of its whole type becomes the nearest.
void put_ply_number(std::string& out, double number, PlyType type, bool swap);

enum class PlyEncoding { ascii, little, big };

/// Name in a header: "binary_little_endian".
std::string_view name_of(PlyEncoding encoding);
/// Whether numbers have their bytes in the order that this machine does not have.
bool is_swapped(PlyEncoding encoding);

/// A statement of a PLY header.
struct PlyStatement {
    enum class Kind { comment, format, element, property, end, other };
    Kind kind = Kind::other;
    std::vector<std::string_view> words;    ///< with the keyword; none in an empty line
    std::optional<std::string_view> wrong;  ///< the word that is no format, no count or no type; empty: it is missing

    /// A word, or empty behind the last.
    std::string_view word(std::size_t n) const { return n < words.size() ? words[n] : std::string_view(); }
};

/// The header of a PLY file.
struct PlyHeader {
    struct Property {
        std::string name;
        std::string type_name;  ///< as in the file: "float" or "float32"
        PlyType type = PlyType::float32;
        std::optional<PlyType> count;  ///< for a list: type of its length
    };
    struct Element {
        std::string name;
        std::size_t count = 0;
        std::vector<Property> properties;

        /// Fewest bytes of an entry in a file. In ascii a number takes a digit and a separator, which the file's last one may lack.
        std::size_t bytes(bool ascii) const;
    };

    std::optional<PlyEncoding> encoding;
    std::vector<std::string> comments;  ///< whole lines that begin with `comment` or `obj_info`
    std::vector<Element> elements;

    /// Takes in a line behind the first. What is wrong or missing in it is left at its default, and a property before all elements is left out.
    PlyStatement take(std::string_view line);
};

/// A header as text. @param statements  its elements and properties, a line each
std::string ply_header_text(PlyEncoding encoding, const std::vector<std::string>& comments, const std::vector<std::string>& statements);

}  // namespace fluidcarve
