#include "formats/mesh_file/formats.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
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

Head read_head(FileText& file) {
    if (!file.next()) file.fault_in_all("the file is empty");
    const auto word_of_line = [&] {
        for (auto word = file.word('#');; word = file.word('#')) {
            if (!word.empty()) return word;
            if (!file.next()) file.fault("the file ends too early");
        }
    };
    const auto keyword = word_of_line();
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
        const auto word = glued.empty() ? word_of_line() : std::exchange(glued, {});
        if (word == "BINARY") file.fault("binary OFF can't be read; export it as text");
        const long number = file.whole(word);
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
    const double light = full_light(attribute.type);
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

}  // namespace

void probe_off(FileText& file) { read_head(file); }

Mesh read_off(FileText& file, Losses& losses) {
    const auto head = read_head(file);
    Mesh out;
    auto stored = std::make_shared<Mesh::StoredForm>();
    stored->format = "off";
    stored->number = Type::float64;
    out.stored = stored;
    Numbers numbers;

    Attribute normal{"normal", Attribute::On::vertices, {"nx", "ny", "nz"}, Type::float64, {}, {}};
    Attribute uv{"uv", Attribute::On::vertices, {"s", "t"}, Type::float64, {}, {}};
    std::optional<Attribute> colours;
    const std::size_t others = 3 + (head.normal ? 3 : 0) + (head.uv ? 2 : 0);
    for (std::size_t n = 0; n < head.vertices; ++n) {
        numbers.read(file);
        const auto size = numbers.all.size(), parts = size - std::min(size, others);
        if (size < others || (head.colour ? parts != 3 && parts != 4 : parts != 0) ||
            (colours && colours->parts.size() != parts))
            file.fault(fmt::format("a vertex of this file does not have {} numbers", size));
        out.points.emplace_back(numbers.all[0], numbers.all[1], numbers.all[2]);
        if (head.normal) take(normal, numbers, 3, 3);
        if (head.colour && !colours) colours = colour(Attribute::On::vertices, parts);
        if (colours) take(*colours, numbers, size - parts - (head.uv ? 2 : 0), parts);
        if (head.uv) take(uv, numbers, size - 2, 2);
    }
    if (head.normal) out.attributes.push_back(std::move(normal));
    if (colours) out.attributes.push_back(std::move(*colours));
    if (head.uv) out.attributes.push_back(std::move(uv));

    std::optional<Attribute> painted;
    bool alike = true;
    for (std::size_t n = 0; n < head.faces; ++n) {
        numbers.read(file);
        const double count = numbers.all[0];
        if (!(count >= 3 && numbers.whole[0]))
            file.fault(fmt::format("a face needs at least three corners, not {}", count));
        if (count > static_cast<double>(numbers.all.size() - 1))
            file.fault(fmt::format("a face of {} corners has only {} numbers behind the count",
                                   count, numbers.all.size() - 1));
        const auto corners = static_cast<std::size_t>(count);
        for (std::size_t c = 1; c <= corners; ++c) {
            const double vertex = numbers.all[c];
            if (!(vertex >= 0 && vertex < static_cast<double>(head.vertices) && numbers.whole[c]))
                file.fault(fmt::format("a face has a vertex {}, but there are {}, counted from 0",
                                       vertex, head.vertices));
            out.corners.push_back(static_cast<std::uint32_t>(vertex));
        }
        out.ends.push_back(out.corners.size());
        const auto parts = numbers.all.size() - 1 - corners;
        if (n == 0 && (parts == 1 || parts == 3 || parts == 4))
            painted = colour(Attribute::On::faces, parts);
        alike = alike && parts == (painted ? painted->parts.size() : 0);
        if (painted && alike) take(*painted, numbers, 1 + corners, parts);
    }
    if (!alike)
        losses.emplace_back(
            "the colours of faces are left out: not all faces have as many numbers of them");
    else if (painted) out.attributes.push_back(std::move(*painted));
    if (file.has_comments()) losses.emplace_back("comments are left out");
    return out;
}

std::string off_text(const Mesh& mesh, const std::vector<Vec3d>& points, Losses& losses) {
    std::vector<Attribute> made;  // attributes on corners, converted to vertices
    made.reserve(mesh.attributes.size());
    const Attribute *uv = nullptr, *normal = nullptr, *colours = nullptr, *painted = nullptr;
    for (const auto& attribute : mesh.attributes) {
        const auto parts = attribute.parts.size();
        const bool on_faces = attribute.on == Attribute::On::faces,
                   is_colour = attribute.name == "colour" && (parts == 3 || parts == 4);
        auto& slot = on_faces                     ? painted
                     : attribute.name == "uv"     ? uv
                     : attribute.name == "normal" ? normal
                                                  : colours;
        const bool fits = is_colour || (on_faces ? attribute.name == "colour_index" && parts == 1
                                                 : (attribute.name == "uv" && parts == 2) ||
                                                       (attribute.name == "normal" && parts == 3));
        std::size_t several = 0;
        if (!fits || slot)
            lose(losses, attribute, fmt::format(".off holds none of {}", text_of(attribute.on)));
        else if (attribute.on != Attribute::On::corners) slot = &attribute;
        else if (auto single = per_vertex(mesh, attribute, several))
            slot = &made.emplace_back(std::move(*single));
        else
            lose(losses, attribute,
                 fmt::format(".off holds one per vertex, and {} {} several or corners without",
                             several, several == 1 ? "vertex has" : "vertices have"));
    }
    for (const auto* const attribute : {colours, painted})
        if (attribute && attribute->name == "colour" && full_light(attribute->type) > 255)
            losses.push_back(
                fmt::format("colours of {} are rounded to bytes: .off holds no finer whole ones",
                            text_of(attribute->on)));
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
