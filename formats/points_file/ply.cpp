#include "formats/points_file/ply.h"

#include "carve/base/failure.h"
#include "carve/base/one_line.h"
#include "formats/file/input_file.h"
#include "formats/file/output_file.h"
#include "formats/geometry_file/file_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>

namespace fluidcarve {

namespace {

constexpr std::size_t longest_header = 1 << 20;
constexpr std::size_t chunk = 1 << 20;  ///< bytes read or written at once, about
constexpr FileUse point_file{.what = "a file of points", .folder = "is not a file"};

/// Whether a text is printable ASCII without spaces, which all programs read.
bool is_plain(std::string_view text) {
    return std::ranges::all_of(text, [](char c) { return c > 0x20 && c < 0x7f; });
}

bool is_text(std::string_view text) {
    return std::ranges::none_of(
        text, [](char c) { return static_cast<unsigned char>(c) < 0x20 && c != '\t'; });
}

/// std::from_chars, except that a number too small for its type becomes the nearest value.
template <class T>
std::from_chars_result parse(const char* begin, const char* end, T& value) {
    const auto parsed = std::from_chars(begin, end, value);
    if constexpr (std::is_floating_point_v<T>) {
        long double wide = 0;
        if (parsed.ec != std::errc::result_out_of_range ||
            std::from_chars(begin, end, wide).ec != std::errc() || std::abs(wide) > 1)
            return parsed;
        value = static_cast<T>(wide);
        return {parsed.ptr, std::errc()};
    }
    return parsed;
}

/// Reads the header and the vertices of a PLY file.
class Reader {
public:
    explicit Reader(const std::string& path) : file_(path, point_file) {
        // Most headers are short, and many are read on a network.
        if (!read_header(std::size_t{1} << 16) && !read_header(longest_header))
            damaged(fmt::format("its header is longer than {} bytes", longest_header));
    }

    PointTable take() { return std::move(points_); }

    void values() {
        for (auto& column : points_.columns)
            column.values.resize(points_.size * bytes_of(column.type));
        points_.encoding == NumberForm::ascii ? ascii() : binary();
        file_.require_same_size();
        for (std::size_t row = 0; row < points_.size; ++row)
            if (!openvdb::math::isFinite(points_.position(row)))
                damaged(fmt::format("the position of vertex {} is not finite", row));
    }

private:
    /// @param message  a format string with {} for the path
    [[noreturn]] void refuse(const std::string& message) const {
        throw Failure(fmt::format(fmt::runtime(message), file_.path()), Failure::Kind::input);
    }
    [[noreturn]] void damaged(const std::string& fault) const {
        throw Failure(fmt::format("{} is damaged: {}", file_.path(), fault), Failure::Kind::input);
    }
    [[noreturn]] void cut_off(const std::string& what) const {
        throw Failure(fmt::format("{} is cut off: {}; copy or write it again", file_.path(), what),
                      Failure::Kind::input);
    }

    /// @param most  reads only so many bytes from the beginning
    /// @return false if the header is longer
    bool read_header(std::size_t most) {
        points_ = {};
        counted_ = false;
        FileText head(file_, most);
        const auto next = [&] {
            const bool whole = head.next() && head.line_ends();
            if (!whole && !head.ran_out()) cut_off("it ends within its header");
            return whole;
        };
        if (!head.rest().starts_with("ply")) refuse("{} is not a PLY file");
        if (!next()) return false;
        if (head.line() != "ply") refuse("{} is not a PLY file");
        PlyHeader header;
        do {
            if (!next()) return false;
            if (head.line() != "end_header")
                accept(header.take(head.line()), header, std::string(head.line()));
        } while (head.line() != "end_header");
        if (!header.encoding) damaged("its header does not say which format it has");
        if (!counted_) refuse("{} has no vertices: no 'element vertex' in its header");
        for (const auto* const name : {"x", "y", "z"}) {
            const auto* const found = points_.column(name);
            if (!found || !is_floating(found->type))
                refuse(std::string("{} has no vertex property '") + name +
                       "' of type float or double");
        }
        points_.encoding = *header.encoding;
        points_.comments = std::move(header.comments);
        begins_ = file_.size() - head.left();
        require_size(std::ranges::find_if(header.elements, is_vertex)
                         ->bytes(points_.encoding == NumberForm::ascii));
        return true;
    }

    /// @param row  fewest bytes of a vertex
    void require_size(std::size_t row) const {
        // The last number of an ascii file needs no separator.
        const std::uint64_t left =
            file_.size() - begins_ + (points_.encoding == NumberForm::ascii ? 1 : 0);
        if (points_.size > left / row)
            cut_off(fmt::format(
                "it states {} vertices of {} or more bytes, but has {} bytes after its header",
                points_.size, row, file_.size() - begins_));
    }

    static bool is_vertex(const PlyHeader::Element& element) { return element.name == "vertex"; }

    /// Accepts a line of the header, or refuses it. @param header  up to this line
    void accept(const PlyStatement& statement, const PlyHeader& header, const std::string& text) {
        using Kind = PlyStatement::Kind;
        const auto words = statement.words.size();
        if (words == 0) return;
        if (!is_text(text)) damaged("its header has a line that is no text");
        if (statement.kind == Kind::comment) return;
        if (statement.kind == Kind::format && words == 3) {
            if (statement.wrong || statement.word(2) != "1.0")
                refuse("{} has the format '" + shown(text.substr(7)) +
                       "', which is not one of PLY 1.0");
        } else if (statement.kind == Kind::element && words == 3) {
            element(statement, header.elements.back(), text);
        } else if (statement.kind == Kind::property && words >= 3) {
            if (header.elements.empty()) damaged("a property stands before the first element");
            if (is_vertex(header.elements.back()))
                property(statement, header.elements.back().properties.back());
            else points_.empty_elements.push_back(text);
        } else {
            damaged("its header has the line '" + shown(text) + "'");
        }
    }

    void element(const PlyStatement& statement, const PlyHeader::Element& element,
                 const std::string& text) {
        if (statement.wrong)
            damaged("its header counts '" + shown(std::string(*statement.wrong)) +
                    "' of an element");
        if (is_vertex(element)) {
            if (counted_) damaged("it has two elements 'vertex'");
            if (element.count > 0xffffffffu)
                damaged(fmt::format("it states {} vertices; the most is {}", element.count,
                                    0xffffffffu));
            counted_ = true;
            points_.size = element.count;
        } else if (element.count > 0) {
            refuse("{} has elements '" + shown(element.name) +
                   "', which would lose their vertices: read it by mesh.read, or save its points "
                   "alone");
        } else {
            points_.empty_elements.push_back(text);
        }
    }

    void property(const PlyStatement& statement, const PlyHeader::Property& property) {
        const auto place = fmt::format("vertex property {}", points_.columns.size() + 1);
        if (property.count)
            refuse("{} has the list '" + shown(std::string(statement.words.back())) +
                   "' at its vertices, which points can't hold; save it without");
        if (statement.wrong)
            damaged(place + " is of the type '" + shown(property.type_name) +
                    "', which PLY does not have");
        if (statement.words.size() > 3 || !is_plain(property.name))
            damaged(place + " has a name that is not plain text");
        if (points_.column(property.name))
            damaged("it has two vertex properties '" + property.name + "'");
        points_.columns.push_back({property.name, property.type_name, property.type, {}});
    }

    /// Shortens a text for a message, and removes braces, which the message's format would
    /// interpret.
    static std::string shown(std::string text) {
        text = one_line(std::move(text)).substr(0, 60);
        std::replace_if(
            text.begin(), text.end(),
            [](char c) { return c == '{' || c == '}' || static_cast<unsigned char>(c) >= 0x80; },
            '?');
        return text;
    }

    void ascii() {
        std::string text(file_.size() - begins_, '\0');
        file_.read(begins_, text.data(), text.size());
        const char* at = text.data();
        const char* const end = at + text.size();
        const auto is_space = [](char c) {
            return c == ' ' || c == '\n' || c == '\r' || c == '\t';
        };
        for (std::size_t row = 0; row < points_.size; ++row)
            for (auto& column : points_.columns) {
                at = std::find_if_not(at, end, is_space);
                const auto* const to = std::find_if(at, end, is_space);
                if (at == to)
                    cut_off(fmt::format("it states {} vertices and ends in vertex {}", points_.size,
                                        row));
                with_number_type(column.type, [&](auto value) {
                    const auto parsed = parse(*at == '+' ? at + 1 : at, to, value);
                    if (parsed.ec != std::errc() || parsed.ptr != to)
                        damaged(fmt::format("vertex {} has '{}' as {}, a {}", row,
                                            shown(std::string(at, to)), column.name,
                                            column.type_name));
                    std::memcpy(column.values.data() + row * sizeof value, &value, sizeof value);
                });
                at = to;
            }
        if (std::find_if_not(at, end, is_space) != end)
            damaged(fmt::format("it goes on after the {} vertices that it states", points_.size));
    }

    void binary() {
        std::size_t length = 0;
        for (const auto& column : points_.columns) length += bytes_of(column.type);
        const bool swaps = is_swapped(points_.encoding);
        const auto rows = std::max<std::size_t>(1, chunk / length);
        std::vector<char> bytes(rows * length);
        for (std::size_t first = 0; first < points_.size; first += rows) {
            const auto end = std::min(first + rows, points_.size);
            file_.read(begins_ + first * length, bytes.data(), (end - first) * length);
            const char* from = bytes.data();
            for (auto n = first; n < end; ++n)
                for (auto& column : points_.columns) {
                    const auto size = bytes_of(column.type);
                    auto* const to = column.values.data() + n * size;
                    swaps ? void(std::reverse_copy(from, from + size, to))
                          : void(std::copy(from, from + size, to));
                    from += size;
                }
        }
        if (file_.size() - begins_ != points_.size * length)
            damaged(fmt::format("it goes on after the {} vertices that it states", points_.size));
    }

    InputFile file_;
    std::uint64_t begins_ = 0;
    bool counted_ = false;
    PointTable points_;
};

static_assert(std::endian::native == std::endian::little, "columns are little-endian");

std::string header_of(const PointTable& points) {
    std::vector<std::string> statements{fmt::format("element vertex {}", points.size)};
    for (const auto& column : points.columns)
        statements.push_back(fmt::format("property {} {}", column.type_name, column.name));
    statements.insert(statements.end(), points.empty_elements.begin(), points.empty_elements.end());
    return ply_header_text(points.encoding, points.comments, statements);
}

void append_row(std::string& out, const PointTable& points, std::size_t row) {
    for (const auto& column : points.columns) {
        const auto size = bytes_of(column.type);
        const auto* const from = column.values.data() + row * size;
        if (points.encoding == NumberForm::little) out.append(from, size);
        else if (points.encoding == NumberForm::big)
            out.append(std::make_reverse_iterator(from + size), std::make_reverse_iterator(from));
        else
            with_number_type(column.type, [&](auto value) {
                std::memcpy(&value, from, size);
                if constexpr (sizeof value == 1) out += fmt::format("{} ", static_cast<int>(value));
                else out += fmt::format("{} ", value);
            });
    }
    if (points.encoding == NumberForm::ascii) out.back() = '\n';
}

}  // namespace

bool is_ply(const std::string& path) {
    const auto start = InputFile(path, point_file).head(4);
    return start == "ply\n" || start == "ply\r";
}

PointTable read_ply(const std::string& path) {
    Reader reader(path);
    reader.values();
    return reader.take();
}

PointTable read_ply_header(const std::string& path) { return Reader(path).take(); }

bool holds_points(const std::string& path) {
    try {
        read_ply_header(path);
        return true;
    } catch (const Failure&) {
        return false;
    }
}

void write_ply(const std::string& path, const PointTable& points) {
    OutputFile output(path);
    std::ofstream file(output.aside(), std::ios_base::binary | std::ios_base::trunc);
    auto text = header_of(points);
    for (std::size_t row = 0; row < points.size; ++row) {
        append_row(text, points, row);
        if (text.size() < chunk) continue;
        file.write(text.data(), static_cast<std::streamsize>(text.size()));
        text.clear();
    }
    file.write(text.data(), static_cast<std::streamsize>(text.size()));
    output.commit(file);
}

}  // namespace fluidcarve
