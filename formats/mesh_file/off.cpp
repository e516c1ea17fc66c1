#include "formats/mesh_file/mesh_formats.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

namespace fluidcarve {
namespace {

using Attribute = Mesh::Attribute;
using Type = Attribute::Type;
using openvdb::Vec3d;

/// The header of an OFF file: which data vertices have, and the counts.
struct Head {
    bool uv, colour, normal;
    std::size_t vertices, faces;
};

/// The next word of this or a later line.
std::string_view word_behind_comments(FileText& file) {
    for (auto word = file.word('#');; word = file.word('#')) {
        if (!word.empty()) return word;
        if (!file.next()) file.fault("the file ends too early");
    }
}

Head read_head(FileText& file) {
    if (!file.next()) file.fault_in_all("the file is empty");
    const auto keyword = word_behind_comments(file);
    auto rest = keyword;
    const auto has = [&](std::string_view prefix) {
        if (!rest.starts_with(prefix)) return false;
        rest.remove_prefix(prefix.size());
        return true;
    };
    Head out{};
    out.uv = has("ST");
    out.colour = has("C");
    out.normal = has("N");
    // Files of ModelNet have their first count right behind the keyword.
    auto glued = rest.starts_with("OFF") ? rest.substr(3) : std::string_view();
    if (!rest.starts_with("OFF") || glued.find_first_not_of("0123456789") != std::string_view::npos)
        file.fault(fmt::format("this is no OFF file of three-dimensional points: it begins with {}",
                               quoted(keyword)));
    const auto count = [&] {
        const auto word = glued.empty() ? word_behind_comments(file) : std::exchange(glued, {});
        if (word == "BINARY") file.fault("binary OFF can't be read; export it as text");
        const long number = file.whole_number(word);
        if (number < 0) file.fault(fmt::format("{} is no count", quoted(word)));
        return static_cast<std::size_t>(number);
    };
    out.vertices = count();
    out.faces = count();
    count();  // the number of edges is not used
    const auto left = file.left() + 1;
    if (out.vertices > left / 6 || out.faces > left / 8)
        file.fault_in_all(
            fmt::format("the head promises {} vertices and {} faces, for which the file is too "
                        "short: it is cut off or damaged",
                        out.vertices, out.faces));
    return out;
}

/// The numbers of one line.
struct Numbers {
    std::vector<double> all;
    std::vector<bool> whole;  ///< per number: written without a decimal point

    void read(FileText& file) {
        all.clear();
        whole.clear();
        while (all.empty()) {
            if (!file.next()) file.fault("the file ends too early");
            for (auto word = file.word('#'); !word.empty(); word = file.word('#')) {
                all.push_back(file.number(word));
                whole.push_back(word.find_first_of(".eE") == std::string_view::npos);
            }
        }
    }
};

/// Adds `count` numbers of a line, from `first` on, to an attribute. Colours are bytes unless a
/// number has a decimal point.
void take(Attribute& into, const Numbers& numbers, std::size_t first, std::size_t count) {
    for (auto n = first; n < first + count; ++n) {
        into.values.push_back(numbers.all[n]);
        if (!numbers.whole[n]) into.type = Type::float64;
    }
}

Attribute colour(Attribute::On on, std::size_t parts) {
    Attribute out{"colour", on, {"red", "green", "blue"}, Type::uint8, {}, {}};
    if (parts == 4) out.parts.emplace_back("alpha");
    if (parts == 1) out.name = "colour_index", out.parts = {"index"}, out.type = Type::int32;
    return out;
}

/// Writes a colour as in OFF: integers up to 255, or numbers up to 1, which never look like
/// integers.
void put_colours(fmt::memory_buffer& text, const Attribute& attribute, std::size_t n) {
    const auto to = std::back_inserter(text);
    const double light = full_intensity(attribute.type);
    const bool index = attribute.name == "colour_index";
    for (const double part : attribute.entry(n))
        if (light == 1) {
            const auto word = fmt::format("{}", part);
            fmt::format_to(to, " {}{}", word,
                           word.find_first_of(".e") == std::string::npos ? ".0" : "");
        } else
            fmt::format_to(to, " {}",
                           index || light == 255 ? part : std::round(part * 255 / light));
}

/// Reads the vertices and faces behind the head of an OFF file.
class OffReader {
public:
    OffReader(FileText& file, const Head& head, Mesh& out) : file_(file), head_(head), out_(out) {}

    void read_vertices() {
        for (std::size_t n = 0; n < head_.vertices; ++n) take_vertex();
        if (head_.normal) out_.attributes.push_back(std::move(normal_));
        if (colours_) out_.attributes.push_back(std::move(*colours_));
        if (head_.uv) out_.attributes.push_back(std::move(uv_));
    }
    void read_faces(Losses& losses) {
        for (std::size_t n = 0; n < head_.faces; ++n) {
            const auto corners = take_corners();
            const auto parts = numbers_.all.size() - 1 - corners;
            if (n == 0 && (parts == 1 || parts == 3 || parts == 4))
                painted_ = colour(Attribute::On::faces, parts);
            alike_ = alike_ && parts == (painted_ ? painted_->parts.size() : 0);
            if (painted_ && alike_) take(*painted_, numbers_, 1 + corners, parts);
        }
        if (!alike_)
            losses.emplace_back(
                "the colours of faces are left out: not all faces have as many numbers of them");
        else if (painted_) out_.attributes.push_back(std::move(*painted_));
    }

private:
    void take_vertex() {
        numbers_.read(file_);
        const auto others = std::size_t{3} + (head_.normal ? 3 : 0) + (head_.uv ? 2 : 0);
        const auto size = numbers_.all.size(), parts = size - std::min(size, others);
        if (size < others || (head_.colour ? parts != 3 && parts != 4 : parts != 0) ||
            (colours_ && colours_->parts.size() != parts))
            file_.fault(fmt::format("a vertex of this file does not have {} numbers", size));
        out_.points.emplace_back(numbers_.all[0], numbers_.all[1], numbers_.all[2]);
        if (head_.normal) take(normal_, numbers_, 3, 3);
        if (head_.colour && !colours_) colours_ = colour(Attribute::On::vertices, parts);
        if (colours_) take(*colours_, numbers_, size - parts - (head_.uv ? 2 : 0), parts);
        if (head_.uv) take(uv_, numbers_, size - 2, 2);
    }
    /// Reads the line of a face.
    /// @return its number of corners
    std::size_t take_corners() {
        numbers_.read(file_);
        const double count = numbers_.all[0];
        if (!(count >= 3 && numbers_.whole[0]))
            file_.fault(fmt::format("a face needs at least three corners, not {}", count));
        if (count > static_cast<double>(numbers_.all.size() - 1))
            file_.fault(fmt::format("a face of {} corners has only {} numbers behind the count",
                                    count, numbers_.all.size() - 1));
        const auto corners = static_cast<std::size_t>(count);
        for (std::size_t c = 1; c <= corners; ++c) {
            const double vertex = numbers_.all[c];
            if (!(vertex >= 0 && vertex < static_cast<double>(head_.vertices) && numbers_.whole[c]))
                file_.fault(fmt::format("a face has a vertex {}, but there are {}, counted from 0",
                                        vertex, head_.vertices));
            out_.corners.push_back(static_cast<std::uint32_t>(vertex));
        }
        out_.ends.push_back(out_.corners.size());
        return corners;
    }

    FileText& file_;
    const Head head_;
    Mesh& out_;
    Numbers numbers_{};  ///< of the line
    Attribute normal_{"normal", Attribute::On::vertices, {"nx", "ny", "nz"}, Type::float64, {}, {}};
    Attribute uv_{"uv", Attribute::On::vertices, {"s", "t"}, Type::float64, {}, {}};
    std::optional<Attribute> colours_, painted_;  ///< of vertices, and of faces
    bool alike_ = true;  ///< whether all faces have as many numbers behind their corners
};

/// The attributes that an OFF file holds; null: none.
struct OffAttributes {
    const Attribute *uv = nullptr, *normal = nullptr, *colours = nullptr, *painted = nullptr;
};

/// @param made  gets the attributes on corners, converted to vertices
OffAttributes off_attributes(const Mesh& mesh, std::vector<Attribute>& made, Losses& losses) {
    made.reserve(mesh.attributes.size());
    OffAttributes out;
    for (const auto& attribute : mesh.attributes) {
        const auto parts = attribute.parts.size();
        const bool on_faces = attribute.on == Attribute::On::faces,
                   is_colour = attribute.name == "colour" && (parts == 3 || parts == 4);
        auto& slot = on_faces                     ? out.painted
                     : attribute.name == "uv"     ? out.uv
                     : attribute.name == "normal" ? out.normal
                                                  : out.colours;
        const bool fits = is_colour || (on_faces ? attribute.name == "colour_index" && parts == 1
                                                 : (attribute.name == "uv" && parts == 2) ||
                                                       (attribute.name == "normal" && parts == 3));
        std::size_t several = 0;
        if (!fits || slot)
            lose(losses, attribute, fmt::format(".off holds none of {}", to_text(attribute.on)));
        else if (attribute.on != Attribute::On::corners) slot = &attribute;
        else if (auto single = per_vertex(mesh, attribute, several))
            slot = &made.emplace_back(std::move(*single));
        else
            lose(losses, attribute,
                 fmt::format(".off holds one per vertex, and {} {} several or corners without",
                             several, several == 1 ? "vertex has" : "vertices have"));
    }
    for (const auto* const attribute : {out.colours, out.painted})
        if (attribute && attribute->name == "colour" && full_intensity(attribute->type) > 255)
            losses.push_back(
                fmt::format("colours of {} are rounded to bytes: .off holds no finer whole ones",
                            to_text(attribute->on)));
    return out;
}

}  // namespace

void probe_off(FileText& file) { read_head(file); }

Mesh read_off(FileText& file, Losses& losses) {
    Mesh out;
    auto stored = std::make_shared<Mesh::StoredForm>();
    stored->format = "off";
    stored->number = Type::float64;
    out.stored = std::move(stored);
    OffReader reader(file, read_head(file), out);
    reader.read_vertices();
    reader.read_faces(losses);
    if (file.has_comments()) losses.emplace_back("comments are left out");
    return out;
}

std::string off_text(const Mesh& mesh, const std::vector<Vec3d>& points, Losses& losses) {
    std::vector<Attribute> made;
    const auto [uv, normal, colours, painted] = off_attributes(mesh, made, losses);
    lines_for(mesh, "off", losses);

    fmt::memory_buffer text;
    const auto to = std::back_inserter(text);
    fmt::format_to(to, "{}{}{}OFF\n{} {} 0\n", uv ? "ST" : "", colours ? "C" : "",
                   normal ? "N" : "", points.size(), mesh.faces());
    for (std::size_t n = 0; n < points.size(); ++n) {
        fmt::format_to(to, "{} {} {}", points[n].x(), points[n].y(), points[n].z());
        if (normal) fmt::format_to(to, " {}", fmt::join(normal->entry(n), " "));
        if (colours) put_colours(text, *colours, n);
        if (uv) fmt::format_to(to, " {}", fmt::join(uv->entry(n), " "));
        text.push_back('\n');
    }
    for (std::size_t n = 0; n < mesh.faces(); ++n) {
        fmt::format_to(to, "{} {}", mesh.face(n).size(), fmt::join(mesh.face(n), " "));
        if (painted) put_colours(text, *painted, n);
        text.push_back('\n');
    }
    return fmt::to_string(text);
}

}  // namespace fluidcarve
