#include "nodes/rig/curve_file.h"

#include "graph/text/problem.h"
#include "graph/text/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string_view>

namespace fluidcarve {

using openvdb::Vec3d;

namespace {

using Words = std::vector<std::string_view>;

Words split(std::string_view line, std::string_view separators) {
    Words out;
    for (std::size_t begin = 0; (begin = line.find_first_not_of(separators, begin)) != std::string_view::npos;) {
        const auto end = std::min(line.find_first_of(separators, begin), line.size());
        out.push_back(line.substr(begin, end - begin));
        begin = end;
    }
    return out;
}

template <class Number>
std::optional<Number> parsed(std::string_view text) {
    if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
    Number out{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
    const bool good = error == std::errc{} && end == text.data() + text.size();
    return good && std::isfinite(static_cast<double>(out)) ? std::optional(out) : std::nullopt;
}

/// Reads a text file line by line.
class Lines {
public:
    explicit Lines(const std::string& path) : path_(path), in_(path, std::ios::binary) {
        std::error_code ignored;
        if (std::filesystem::is_directory(path, ignored)) throw Failure(path + " is a folder", Failure::Kind::input);
        if (!in_) throw Failure(path + " can't be opened", Failure::Kind::input);
    }

    bool next() {
        if (!std::getline(in_, line_)) return false;
        if (!line_.empty() && line_.back() == '\r') line_.pop_back();
        ++number_;
        return true;
    }
    const std::string& line() const { return line_; }
    int number() const { return number_; }

    [[noreturn]] void fault(const std::string& message) const { fault_at(number_, message); }
    [[noreturn]] void fault_at(int number, const std::string& message) const {
        throw Failure(fmt::format("{}:{}: {}", path_, number, message), Failure::Kind::input);
    }
    [[noreturn]] void fault_in_all(const std::string& message) const { throw Failure(fmt::format("{}: {}", path_, message), Failure::Kind::input); }

    double coordinate(std::string_view word) const {
        const auto number = parsed<double>(word);
        if (!number) fault(fmt::format("'{}' is no number", word.substr(0, 40)));
        return *number;
    }
    /// The point in three columns of a line.
    Vec3d point(const Words& words, const std::array<std::size_t, 3>& columns) const {
        if (words.size() <= *std::max_element(columns.begin(), columns.end())) fault("this point lacks a coordinate");
        return {coordinate(words[columns[0]]), coordinate(words[columns[1]]), coordinate(words[columns[2]])};
    }

private:
    std::string path_;
    std::ifstream in_;
    std::string line_;
    int number_ = 0;
};

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
    std::vector<std::size_t> points(const Lines& file) const {
        for (const auto& [point, ends] : joined_)
            if (ends.size() > 2)
                file.fault_at(edges_[ends[2].edge], fmt::format("a third line ends at vertex {}: a rig is one line without branches", point + 1));
        std::vector<bool> used(edges_.size());
        used[0] = true;
        auto forward = walk(first_[1], used), out = walk(first_[0], used);
        std::reverse(out.begin(), out.end());
        out.insert(out.end(), forward.begin(), forward.end());
        if (const auto rest = std::find(used.begin(), used.end(), false); rest != used.end())
            file.fault_at(edges_[static_cast<std::size_t>(rest - used.begin())], "this line is not joined to the first one: a rig is one line");
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

std::vector<Vec3d> read_obj(Lines& file) {
    std::vector<Vec3d> vertices;
    Chain chain;
    const auto vertex = [&](std::string_view word) {
        const auto index = parsed<long>(word.substr(0, word.find('/')));
        const auto count = static_cast<long>(vertices.size());
        if (!index || *index == 0 || *index > count || *index < -count)
            file.fault(fmt::format("'{}' is none of the {} vertices above", word.substr(0, 40), count));
        return static_cast<std::size_t>(*index > 0 ? *index - 1 : count + *index);
    };
    while (file.next()) {
        const auto words = split(file.line(), " \t");
        if (words.empty()) continue;
        if (words[0] == "v") vertices.push_back(file.point(words, {1, 2, 3}));
        if (words[0] != "l") continue;
        if (words.size() < 3) file.fault("a line needs at least two vertices");
        for (std::size_t n = 2; n < words.size(); ++n) chain.add(vertex(words[n - 1]), vertex(words[n]), file.number());
    }
    if (chain.empty()) file.fault_in_all("there is no line in it (element 'l'): export a curve as lines, not as faces");
    std::vector<Vec3d> out;
    for (const auto n : chain.points(file)) out.push_back(vertices[n]);
    return out;
}

std::vector<Vec3d> read_ply(Lines& file) {
    if (!file.next() || file.line() != "ply") file.fault("this is no PLY file: its first line is not 'ply'");
    struct Element {
        std::string name;
        unsigned long count;
        std::vector<std::string> properties;
    };
    std::vector<Element> elements;
    while (true) {
        if (!file.next()) file.fault("the header has no 'end_header'");
        const auto words = split(file.line(), " \t");
        if (words.empty()) continue;
        if (words[0] == "end_header") break;
        if (words[0] == "format" && (words.size() < 2 || words[1] != "ascii")) file.fault("only PLY files of format ascii can be read here");
        if (words[0] == "element") {
            const auto count = words.size() == 3 ? parsed<unsigned long>(words[2]) : std::nullopt;
            if (!count) file.fault("an element needs a name and a count");
            elements.push_back({std::string(words[1]), *count, {}});
        }
        if (words[0] == "property" && !elements.empty()) elements.back().properties.emplace_back(words.back());
        if (words[0] == "property" && !elements.empty() && elements.back().name == "vertex" && words.size() != 3)
            file.fault("a vertex with a list among its properties can't be read here");
    }
    for (const auto& element : elements) {
        std::array<std::size_t, 3> columns{};
        if (element.name == "vertex")
            for (std::size_t c = 0; c < 3; ++c) {
                const auto found = std::find(element.properties.begin(), element.properties.end(), std::string(1, "xyz"[c]));
                if (found == element.properties.end()) file.fault(fmt::format("element 'vertex' has no property '{}'", "xyz"[c]));
                columns[c] = static_cast<std::size_t>(found - element.properties.begin());
            }
        std::vector<Vec3d> out;
        for (unsigned long n = 0; n < element.count; ++n) {
            if (!file.next()) file.fault(fmt::format("the file ends after {} of {} lines of element '{}'", n, element.count, element.name));
            if (element.name == "vertex") out.push_back(file.point(split(file.line(), " \t"), columns));
        }
        if (element.name == "vertex") return out;
    }
    file.fault_in_all("there is no element 'vertex' in it");
}

std::vector<Vec3d> read_csv(Lines& file) {
    std::array<std::size_t, 3> columns{0, 1, 2};
    std::vector<Vec3d> out;
    for (bool first = true; file.next();) {
        const auto text = std::string_view(file.line()).substr(0, file.line().find('#'));
        const auto words = split(text, ",; \t");
        if (words.empty()) continue;
        // A header is a first line that does not begin with a number.
        if (first && !parsed<double>(words[0])) {
            for (std::size_t c = 0; c < 3; ++c) {
                const auto named = [&](std::string_view word) { return word.size() == 1 && (word[0] == "xyz"[c] || word[0] == "XYZ"[c]); };
                const auto found = std::find_if(words.begin(), words.end(), named);
                if (found == words.end()) file.fault(fmt::format("the header has no column '{}'", "xyz"[c]));
                columns[c] = static_cast<std::size_t>(found - words.begin());
            }
        } else {
            out.push_back(file.point(words, columns));
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
        throw Failure(fmt::format("{}: a curve is read from .obj, .ply or .csv, not from '{}'", path, ending), Failure::Kind::input);
    Lines file(path);
    return ending == ".obj" ? read_obj(file) : ending == ".ply" ? read_ply(file) : read_csv(file);
}

}  // namespace fluidcarve
