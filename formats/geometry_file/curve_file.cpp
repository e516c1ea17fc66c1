#include "formats/geometry_file/curve_file.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "formats/geometry_file/file_text.h"
#include "formats/geometry_file/obj.h"
#include "formats/geometry_file/ply.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {

using Words = std::vector<std::string_view>;

constexpr std::uint64_t most_bytes = std::uint64_t{64} << 20;

bool is_number(std::string_view word) {
    const auto number = number_of_word<double>(word);
    return number && std::isfinite(*number);
}

/// The point in three columns of a line.
Vec3d point_in(const FileText& file, const Words& words,
               const std::array<std::size_t, 3>& columns) {
    if (words.size() <= *std::ranges::max_element(columns))
        file.fault("this point lacks a coordinate");
    return {file.number(words[columns[0]]), file.number(words[columns[1]]),
            file.number(words[columns[2]])};
}

/// Joins pieces of a line between numbered points.
class Chain {
public:
    /// @param a, b  indices of the piece's ends
    /// @param line  its line number in the file
    void add(std::size_t a, std::size_t b, int line) {
        if (edges_.empty()) first_ = {a, b};
        edges_.push_back(line);
        joined_[a].push_back({b, edges_.size() - 1});
        joined_[b].push_back({a, edges_.size() - 1});
    }
    bool empty() const { return edges_.empty(); }

    /// Indices of the points along the joined line.
    /// @throws Failure (input) if the line has branches or several parts
    std::vector<std::size_t> points(const FileText& file) const {
        for (const auto& [point, ends] : joined_)
            if (ends.size() > 2)
                file.fault_at(
                    edges_[ends[2].edge],
                    fmt::format(
                        "a third line ends at vertex {}: a rig is one line without branches",
                        point + 1));
        std::vector<bool> used(edges_.size());
        used[0] = true;
        auto forward = walk(first_[1], used), out = walk(first_[0], used);
        std::ranges::reverse(out);
        out.insert(out.end(), forward.begin(), forward.end());
        if (const auto rest = std::ranges::find(used, false); rest != used.end())
            file.fault_at(edges_[static_cast<std::size_t>(rest - used.begin())],
                          "this line is not joined to the first one: a rig is one line");
        return out;
    }

private:
    struct End {
        std::size_t point, edge;
    };

    std::vector<std::size_t> walk(std::size_t from, std::vector<bool>& used) const {
        std::vector<std::size_t> out{from};
        for (bool on = true; on;) {
            on = false;
            for (const auto& end : joined_.at(out.back())) {
                if (used[end.edge]) continue;
                used[end.edge] = true;
                out.push_back(end.point);
                on = true;
                break;
            }
        }
        return out;
    }

    std::array<std::size_t, 2> first_{};
    std::vector<int> edges_;  ///< line number in the file of each piece
    std::map<std::size_t, std::vector<End>> joined_;
};

std::vector<Vec3d> read_obj(FileText& file) {
    std::vector<Vec3d> vertices;
    Chain chain;
    const auto vertex = [&](std::string_view word) {
        const auto stated = number_of_word<long>(word.substr(0, word.find('/')));
        const auto out = stated ? obj_index(*stated, vertices.size()) : std::nullopt;
        if (!out || *out >= vertices.size())
            file.fault(
                fmt::format("{} is none of the {} vertices above", quoted(word), vertices.size()));
        return *out;
    };
    while (file.next()) {
        const auto words = words_of(file.line());
        if (words.empty()) continue;
        if (words[0] == "v") vertices.push_back(point_in(file, words, {1, 2, 3}));
        if (words[0] != "l") continue;
        if (words.size() < 3) file.fault("a line needs at least two vertices");
        for (std::size_t n = 2; n < words.size(); ++n)
            chain.add(vertex(words[n - 1]), vertex(words[n]), file.line_number());
    }
    if (chain.empty())
        file.fault_in_all(
            "there is no line in it (element 'l'): export a curve as lines, not as faces");
    std::vector<Vec3d> out;
    for (const auto n : chain.points(file)) out.push_back(vertices[n]);
    return out;
}

PlyHeader ply_header(FileText& file) {
    if (!file.next() || file.line() != "ply")
        file.fault("this is no PLY file: its first line is not 'ply'");
    using Kind = PlyStatement::Kind;
    PlyHeader out;
    for (auto kind = Kind::comment; kind != Kind::end;) {
        if (!file.next()) file.fault("the header has no 'end_header'");
        const auto statement = out.take(file.line());
        kind = statement.kind;
        if (kind == Kind::format && statement.word(1) != name_of(NumberForm::ascii))
            file.fault("only PLY files of format ascii can be read here");
        if (kind == Kind::element && (statement.words.size() != 3 || statement.wrong))
            file.fault("an element needs a name and a count");
        if (kind == Kind::property && !out.elements.empty() &&
            out.elements.back().name == "vertex" && statement.words.size() != 3)
            file.fault("a vertex with a list among its properties can't be read here");
    }
    return out;
}

/// The columns of a vertex that hold its position.
std::array<std::size_t, 3> position_columns(const FileText& file,
                                            const PlyHeader::Element& vertex) {
    std::array<std::size_t, 3> out{};
    for (std::size_t c = 0; c < 3; ++c) {
        const auto found = std::ranges::find(vertex.properties, std::string(1, "xyz"[c]),
                                             &PlyHeader::Property::name);
        if (found == vertex.properties.end())
            file.fault(fmt::format("element 'vertex' has no property '{}'", "xyz"[c]));
        out[c] = static_cast<std::size_t>(found - vertex.properties.begin());
    }
    return out;
}

std::vector<Vec3d> read_ply(FileText& file) {
    const auto header = ply_header(file);
    for (const auto& element : header.elements) {
        const bool is_vertex = element.name == "vertex";
        const auto columns =
            is_vertex ? position_columns(file, element) : std::array<std::size_t, 3>{};
        std::vector<Vec3d> out;
        for (std::size_t n = 0; n < element.count; ++n) {
            if (!file.next())
                file.fault(fmt::format("the file ends after {} of {} lines of element '{}'", n,
                                       element.count, element.name));
            if (is_vertex) out.push_back(point_in(file, words_of(file.line()), columns));
        }
        if (is_vertex) return out;
    }
    file.fault_in_all("there is no element 'vertex' in it");
}

std::vector<Vec3d> read_csv(FileText& file) {
    std::array<std::size_t, 3> columns{0, 1, 2};
    std::vector<Vec3d> out;
    std::size_t cells = 0;
    bool first = true;
    for (auto words = file.next_cells(); !words.empty(); words = file.next_cells()) {
        const auto text = file.line().substr(0, file.line().find('#'));
        if (text.find(',') != std::string_view::npos && text.find(';') != std::string_view::npos)
            file.fault("this line has commas and semicolons: write decimals with a point");
        if (first) cells = words.size();
        if (words.size() > cells)
            file.fault(
                fmt::format("this line has {} cells, the first one {}: write decimals with a point",
                            words.size(), cells));
        // A header is a first line that does not begin with a number.
        if (first && !is_number(words[0])) {
            for (std::size_t c = 0; c < 3; ++c) {
                const auto named = [&](std::string_view word) {
                    return word.size() == 1 && (word[0] == "xyz"[c] || word[0] == "XYZ"[c]);
                };
                const auto found = std::ranges::find_if(words, named);
                if (found == words.end())
                    file.fault(fmt::format("the header has no column '{}'", "xyz"[c]));
                columns[c] = static_cast<std::size_t>(found - words.begin());
            }
        } else {
            out.push_back(point_in(file, words, columns));
        }
        first = false;
    }
    if (out.empty()) file.fault_in_all("there are no points in it");
    return out;
}

}  // namespace

std::vector<Vec3d> read_curve(const std::string& path) {
    const auto ending = ending_of(path);
    if (ending != ".obj" && ending != ".ply" && ending != ".csv")
        throw Failure(
            fmt::format("{}: a curve is read from .obj, .ply or .csv, not from '{}'", path, ending),
            Failure::Kind::input);
    FileText file(InputFile(path, {.what = "a curve", .most = most_bytes}));
    return ending == ".obj" ? read_obj(file) : ending == ".ply" ? read_ply(file) : read_csv(file);
}

}  // namespace fluidcarve
