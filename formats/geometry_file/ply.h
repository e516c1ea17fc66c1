#pragma once

#include "carve/base/numbers.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// Name in a header, the older of its two names: "float", not "float32".
std::string_view name_of(NumberType type);
/// Name in a header: "binary_little_endian".
std::string_view name_of(NumberForm encoding);

/// A statement of a PLY header.
struct PlyStatement {
    enum class Kind { comment, format, element, property, end, other };
    Kind kind = Kind::other;
    std::vector<std::string_view> words;  ///< with the keyword; none in an empty line
    /// The invalid word in place of a format, count or type; empty: the word is missing.
    std::optional<std::string_view> wrong;

    /// A word, or empty behind the last.
    std::string_view word(std::size_t n) const {
        return n < words.size() ? words[n] : std::string_view();
    }
};

/// The header of a PLY file.
struct PlyHeader {
    struct Property {
        std::string name;
        std::string type_name;  ///< as in the file: "float" or "float32"
        NumberType type = NumberType::float32;
        std::optional<NumberType> count;  ///< for a list: type of its length
    };
    struct Element {
        std::string name;
        std::size_t count = 0;
        std::vector<Property> properties;

        /// Fewest bytes of an entry in a file. In ascii a number takes a digit and a separator,
        /// which the file's last one may lack.
        std::size_t bytes(bool ascii) const;
    };

    std::optional<NumberForm> encoding;
    std::vector<std::string> comments;  ///< whole lines that begin with `comment` or `obj_info`
    std::vector<Element> elements;

    /// Parses a line after the first. Wrong or missing parts keep their defaults; a property
    /// before all elements is ignored.
    PlyStatement take(std::string_view line);
};

/// A header as text. @param statements  its elements and properties, a line each
std::string ply_header_text(NumberForm encoding, const std::vector<std::string>& comments,
                            const std::vector<std::string>& statements);

}  // namespace fluidcarve
