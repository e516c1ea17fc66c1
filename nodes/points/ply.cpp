#include "nodes/points/ply.h"

#include "graph/output_file.h"
#include "graph/text/one_line.h"
#include "graph/text/problem.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

namespace fluidcarve {
namespace {

constexpr std::size_t longest_header = 1 << 20;
constexpr std::array<std::string_view, 3> encodings{"ascii", "binary_little_endian", "binary_big_endian"};

template <class Visit>
auto with_type(PlyType type, Visit&& visit) {
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

bool type_of(std::string_view name, PlyType& out) {
    constexpr std::array<std::pair<std::string_view, PlyType>, 16> names{{{"char", PlyType::int8},
                                                                          {"uchar", PlyType::uint8},
                                                                          {"short", PlyType::int16},
                                                                          {"ushort", PlyType::uint16},
                                                                          {"int", PlyType::int32},
                                                                          {"uint", PlyType::uint32},
                                                                          {"float", PlyType::float32},
                                                                          {"double", PlyType::float64},
                                                                          {"int8", PlyType::int8},
                                                                          {"uint8", PlyType::uint8},
                                                                          {"int16", PlyType::int16},
                                                                          {"uint16", PlyType::uint16},
                                                                          {"int32", PlyType::int32},
                                                                          {"uint32", PlyType::uint32},
                                                                          {"float32", PlyType::float32},
                                                                          {"float64", PlyType::float64}}};
    const auto found = std::find_if(names.begin(), names.end(), [&](const auto& each) { return each.first == name; });
    if (found == names.end()) return false;
    out = found->second;
    return true;
}

bool is_floating(PlyType type) { return type == PlyType::float32 || type == PlyType::float64; }

/// Whether a text is printable ASCII without spaces, which all programs read.
bool is_plain(std::string_view text) {
    return std::all_of(text.begin(), text.end(), [](char c) { return c > 0x20 && c < 0x7f; });
}

bool is_text(std::string_view text) {
    return std::none_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 && c != '\t'; });
}

std::vector<std::string> words_of(const std::string& line) {
    std::istringstream in(line);
    return {std::istream_iterator<std::string>(in), {}};
}

/// std::from_chars, except that a number too small for its type becomes the nearest value.
template <class T>
std::from_chars_result parse(const char* begin, const char* end, T& value) {
    const auto parsed = std::from_chars(begin, end, value);
    if constexpr (std::is_floating_point_v<T>) {
        long double wide = 0;
        if (parsed.ec != std::errc::result_out_of_range || std::from_chars(begin, end, wide).ec != std::errc() || std::abs(wide) > 1) return parsed;
        value = static_cast<T>(wide);
        return {parsed.ptr, std::errc()};
    }
    return parsed;
}

/// Reads the header and the vertices of a PLY file.
class Reader {
public:
    explicit Reader(const std::string& path) : path_(path) {
        std::error_code error;
        const auto status = std::filesystem::status(path_, error);
        if (!std::filesystem::exists(status)) refuse("{} does not exist");
        if (!std::filesystem::is_regular_file(status)) refuse("{} is not a file");
        size_ = std::filesystem::file_size(path_, error);
        stream_.open(path_, std::ios_base::binary);
        if (error || !stream_) refuse("cannot open {}: " + (error ? error.message() : std::string(std::strerror(errno))));
        header();
    }

    PlyPoints take() { return std::move(points_); }

    void values() {
        for (auto& column : points_.columns) column.values.resize(points_.size * size_of(column.type));
        points_.encoding == PlyEncoding::ascii ? ascii() : binary();
        for (std::size_t row = 0; row < points_.size; ++row)
            if (!openvdb::math::isFinite(points_.position(row))) damaged(fmt::format("the position of vertex {} is not finite", row));
    }

private:
    /// @param message  a format string with {} for the path
    [[noreturn]] void refuse(const std::string& message) const { throw Failure(fmt::format(fmt::runtime(message), path_), Failure::Kind::input); }
    [[noreturn]] void damaged(const std::string& fault) const { throw Failure(fmt::format("{} is damaged: {}", path_, fault), Failure::Kind::input); }
    [[noreturn]] void cut_off(const std::string& what) const {
        throw Failure(fmt::format("{} is cut off: {}; copy or write it again", path_, what), Failure::Kind::input);
    }

    std::string line() {
        std::string out;
        for (char c; stream_.get(c);) {
            if (++read_ > longest_header) damaged(fmt::format("its header is longer than {} bytes", longest_header));
            if (c != '\n') {
                out += c;
                continue;
            }
            if (!out.empty() && out.back() == '\r') out.pop_back();
            return out;
        }
        cut_off("it ends within its header");
    }

    void header() {
        if (std::array<char, 3> magic{}; !stream_.read(magic.data(), magic.size()) || std::string_view(magic.data(), 3) != "ply")
            refuse("{} is not a PLY file");
        stream_.seekg(0);
        if (line() != "ply") refuse("{} is not a PLY file");
        bool encoded = false, at_vertices = false;
        for (auto text = line(); text != "end_header"; text = line()) {
            const auto words = words_of(text);
            if (words.empty()) continue;
            if (!is_text(text)) damaged("its header has a line that is no text");
            if (words[0] == "comment" || words[0] == "obj_info") {
                points_.comments.push_back(text);
            } else if (words[0] == "format" && words.size() == 3) {
                const auto found = std::find(encodings.begin(), encodings.end(), words[1]);
                if (found == encodings.end() || words[2] != "1.0") refuse("{} has the format '" + shown(text.substr(7)) + "', which is not one of PLY 1.0");
                points_.encoding = static_cast<PlyEncoding>(found - encodings.begin());
                encoded = true;
            } else if (words[0] == "element" && words.size() == 3) {
                at_vertices = words[1] == "vertex";
                element(words, text);
            } else if (words[0] == "property" && words.size() >= 3) {
                if (at_vertices) property(words);
                else if (points_.empty_elements.empty()) damaged("a property stands before the first element");
                else points_.empty_elements.push_back(text);
            } else {
                damaged("its header has the line '" + shown(text) + "'");
            }
        }
        if (!encoded) damaged("its header does not say which format it has");
        if (!counted_) refuse("{} has no vertices: no 'element vertex' in its header");
        for (const auto* const name : {"x", "y", "z"}) {
            const auto* const found = points_.column(name);
            if (!found || !is_floating(found->type)) refuse(std::string("{} has no vertex property '") + name + "' of type float or double");
        }
        begins_ = read_;
        std::size_t row = 0;
        for (const auto& column : points_.columns) row += points_.encoding == PlyEncoding::ascii ? 2 : size_of(column.type);
        // In ascii a value takes at least a digit and a separator; the last value of the file needs no separator.
        const std::uint64_t left = size_ - begins_ + (points_.encoding == PlyEncoding::ascii ? 1 : 0);
        if (points_.size > left / row)
            cut_off(fmt::format("it states {} vertices of {} or more bytes, but has {} bytes after its header", points_.size, row, size_ - begins_));
    }

    void element(const std::vector<std::string>& words, const std::string& text) {
        std::uint64_t count = 0;
        const auto& digits = words[2];
        const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), count);
        if (parsed.ec != std::errc() || parsed.ptr != digits.data() + digits.size()) damaged("its header counts '" + shown(digits) + "' of an element");
        if (words[1] == "vertex") {
            if (counted_) damaged("it has two elements 'vertex'");
            if (count > 0xffffffffu) damaged(fmt::format("it states {} vertices; the most is {}", count, 0xffffffffu));
            counted_ = true;
            points_.size = count;
        } else if (count > 0) {
            refuse("{} has elements '" + shown(words[1]) + "', which would lose their vertices: read it by mesh.read, or save its points alone");
        } else {
            points_.empty_elements.push_back(text);
        }
    }

    void property(const std::vector<std::string>& words) {
        const auto place = fmt::format("vertex property {}", points_.columns.size() + 1);
        if (words[1] == "list") refuse("{} has the list '" + shown(words.back()) + "' at its vertices, which points can't hold; save it without");
        PlyPoints::Column column{words[2], words[1], PlyType::float32, {}};
        if (!type_of(words[1], column.type)) damaged(place + " is of the type '" + shown(words[1]) + "', which PLY does not have");
        if (words.size() > 3 || !is_plain(words[2])) damaged(place + " has a name that is not plain text");
        if (points_.column(words[2])) damaged("it has two vertex properties '" + words[2] + "'");
        points_.columns.push_back(std::move(column));
    }

    /// Shortens a text for a message, and removes braces, which the message's format would interpret.
    static std::string shown(std::string text) {
        text = one_line(std::move(text)).substr(0, 60);
        std::replace_if(
            text.begin(), text.end(), [](char c) { return c == '{' || c == '}' || static_cast<unsigned char>(c) >= 0x80; }, '?');
        return text;
    }

    void ascii() {
        std::string text(size_ - begins_, '\0');
        stream_.read(text.data(), static_cast<std::streamsize>(text.size()));
        const char* at = text.data();
        const char* const end = at + text.size();
        const auto is_space = [](char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; };
        for (std::size_t row = 0; row < points_.size; ++row)
            for (auto& column : points_.columns) {
                at = std::find_if_not(at, end, is_space);
                const auto* const to = std::find_if(at, end, is_space);
                if (at == to) cut_off(fmt::format("it states {} vertices and ends in vertex {}", points_.size, row));
                with_type(column.type, [&](auto value) {
                    const auto parsed = parse(*at == '+' ? at + 1 : at, to, value);
                    if (parsed.ec != std::errc() || parsed.ptr != to)
                        damaged(fmt::format("vertex {} has '{}' as {}, a {}", row, shown(std::string(at, to)), column.name, column.type_name));
                    std::memcpy(column.values.data() + row * sizeof value, &value, sizeof value);
                });
                at = to;
            }
        if (std::find_if_not(at, end, is_space) != end) damaged(fmt::format("it goes on after the {} vertices that it states", points_.size));
    }

    void binary() {
        std::size_t length = 0;
        for (const auto& column : points_.columns) length += size_of(column.type);
        const bool swaps = points_.encoding == PlyEncoding::big;
        std::vector<char> row(length);
        for (std::size_t n = 0; n < points_.size; ++n) {
            if (!stream_.read(row.data(), static_cast<std::streamsize>(length))) cut_off(fmt::format("it ends in vertex {}", n));
            const char* from = row.data();
            for (auto& column : points_.columns) {
                const auto size = size_of(column.type);
                auto* const to = column.values.data() + n * size;
                swaps ? void(std::reverse_copy(from, from + size, to)) : void(std::copy(from, from + size, to));
                from += size;
            }
        }
        if (size_ - begins_ != points_.size * length) damaged(fmt::format("it goes on after the {} vertices that it states", points_.size));
    }

    std::string path_;
    std::uint64_t size_ = 0, begins_ = 0;
    std::size_t read_ = 0;
    std::ifstream stream_;
    bool counted_ = false;
    PlyPoints points_;
};

static_assert(std::endian::native == std::endian::little, "columns are little-endian");

std::string header_of(const PlyPoints& points) {
    std::string out = fmt::format("ply\nformat {} 1.0\n", encodings[static_cast<std::size_t>(points.encoding)]);
    for (const auto& comment : points.comments) out += comment + "\n";
    out += fmt::format("element vertex {}\n", points.size);
    for (const auto& column : points.columns) out += fmt::format("property {} {}\n", column.type_name, column.name);
    for (const auto& text : points.empty_elements) out += text + "\n";
    return out + "end_header\n";
}

void append_row(std::string& out, const PlyPoints& points, std::size_t row) {
    for (const auto& column : points.columns) {
        const auto size = size_of(column.type);
        const auto* const from = column.values.data() + row * size;
        if (points.encoding == PlyEncoding::little) out.append(from, size);
        else if (points.encoding == PlyEncoding::big) out.append(std::make_reverse_iterator(from + size), std::make_reverse_iterator(from));
        else
            with_type(column.type, [&](auto value) {
                std::memcpy(&value, from, size);
                if constexpr (sizeof value == 1) out += fmt::format("{} ", static_cast<int>(value));
                else out += fmt::format("{} ", value);
            });
    }
    if (points.encoding == PlyEncoding::ascii) out.back() = '\n';
}

}  // namespace

std::size_t size_of(PlyType type) {
    return with_type(type, [](auto value) { return sizeof value; });
}

const PlyPoints::Column* PlyPoints::column(std::string_view name) const {
    const auto found = std::find_if(columns.begin(), columns.end(), [&](const Column& each) { return each.name == name; });
    return found == columns.end() ? nullptr : &*found;
}

double PlyPoints::number(const Column& column, std::size_t row) {
    return with_type(column.type, [&](auto value) {
        std::memcpy(&value, column.values.data() + row * sizeof value, sizeof value);
        return static_cast<double>(value);
    });
}

void PlyPoints::set(Column& column, std::size_t row, double number) {
    with_type(column.type, [&](auto value) {
        if constexpr (std::is_floating_point_v<decltype(value)>) value = static_cast<decltype(value)>(number);
        else value = static_cast<decltype(value)>(std::lround(number));
        std::memcpy(column.values.data() + row * sizeof value, &value, sizeof value);
    });
}

openvdb::Vec3d PlyPoints::position(std::size_t row) const { return {number(*column("x"), row), number(*column("y"), row), number(*column("z"), row)}; }

void PlyPoints::set_position(std::size_t row, const openvdb::Vec3d& to) {
    for (auto& each : columns)
        if (each.name.size() == 1 && each.name[0] >= 'x' && each.name[0] <= 'z') set(each, row, to[each.name[0] - 'x']);
}

std::size_t PlyPoints::bytes() const {
    std::size_t out = 0;
    for (const auto& column : columns) out += column.values.size();
    return out;
}

bool is_ply(const std::string& path) {
    std::array<char, 4> start{};
    std::ifstream in(path, std::ios_base::binary);
    return in.read(start.data(), start.size()) && std::string_view(start.data(), 3) == "ply" && (start[3] == '\n' || start[3] == '\r');
}

PlyPoints read_ply(const std::string& path) {
    Reader reader(path);
    reader.values();
    return reader.take();
}

PlyPoints read_ply_header(const std::string& path) { return Reader(path).take(); }

void write_ply(const std::string& path, const PlyPoints& points) {
    OutputFile output(path);
    std::ofstream file(output.aside(), std::ios_base::binary | std::ios_base::trunc);
    auto text = header_of(points);
    constexpr std::size_t chunk = 1 << 20;
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
