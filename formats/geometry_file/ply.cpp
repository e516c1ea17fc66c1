#include "formats/geometry_file/ply.h"

#include "formats/geometry_file/file_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace fluidcarve {

namespace {

/// Names of each type, old and new.
constexpr std::array<std::array<std::string_view, 2>, 8> type_names{{{"char", "int8"},
                                                                     {"uchar", "uint8"},
                                                                     {"short", "int16"},
                                                                     {"ushort", "uint16"},
                                                                     {"int", "int32"},
                                                                     {"uint", "uint32"},
                                                                     {"float", "float32"},
                                                                     {"double", "float64"}}};

constexpr std::array<std::string_view, 3> encoding_names{"ascii", "binary_little_endian",
                                                         "binary_big_endian"};

std::optional<NumberType> type_of(std::string_view word) {
    const auto found = std::ranges::find_if(
        type_names, [&](const auto& each) { return each[0] == word || each[1] == word; });
    return found == type_names.end()
               ? std::nullopt
               : std::optional(static_cast<NumberType>(found - type_names.begin()));
}

}  // namespace

std::string_view name_of(NumberType type) { return type_names[static_cast<std::size_t>(type)][0]; }

std::string_view name_of(NumberForm encoding) {
    return encoding_names[static_cast<std::size_t>(encoding)];
}

std::size_t PlyHeader::Element::bytes(bool ascii) const {
    std::size_t out = 0;
    for (const auto& property : properties)
        out += ascii ? 2 : bytes_of(property.count.value_or(property.type));
    return out;
}

PlyStatement PlyHeader::take(std::string_view line) {
    using Kind = PlyStatement::Kind;
    PlyStatement out;
    out.words = words_of(line);
    const auto keyword = out.word(0);
    const auto type = [&](std::string_view word) {
        const auto found = type_of(word);
        if (!found && !out.wrong) out.wrong = word;
        return found.value_or(NumberType::float32);
    };
    if (keyword == "end_header") {
        out.kind = Kind::end;
    } else if (keyword == "comment" || keyword == "obj_info") {
        out.kind = Kind::comment;
        comments.emplace_back(line);
    } else if (keyword == "format") {
        out.kind = Kind::format;
        const auto found = std::ranges::find(encoding_names, out.word(1));
        if (found == encoding_names.end()) out.wrong = out.word(1);
        else encoding = static_cast<NumberForm>(found - encoding_names.begin());
    } else if (keyword == "element") {
        out.kind = Kind::element;
        const auto count = number_of_word<std::int64_t>(out.word(2));
        if (!count || *count < 0) out.wrong = out.word(2);
        elements.push_back(
            {std::string(out.word(1)), out.wrong ? 0 : static_cast<std::size_t>(*count), {}});
    } else if (keyword == "property") {
        out.kind = Kind::property;
        Property property;
        const bool list = out.word(1) == "list";
        if (list) property.count = type(out.word(2));
        property.type_name = out.word(list ? 3 : 1);
        property.type = type(out.word(list ? 3 : 1));
        property.name = out.word(list ? 4 : 2);
        if (!elements.empty()) elements.back().properties.push_back(std::move(property));
    }
    return out;
}

std::string ply_header_text(NumberForm encoding, const std::vector<std::string>& comments,
                            const std::vector<std::string>& statements) {
    std::string out = fmt::format("ply\nformat {} 1.0\n", name_of(encoding));
    for (const auto* const lines : {&comments, &statements})
        for (const auto& line : *lines) out += line + "\n";
    return out + "end_header\n";
}

}  // namespace fluidcarve
