#include "formats/geometry_file/ply.h"
#include "formats/geometry_file/provenance_comments.h"
#include "formats/mesh_file/mesh_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace fluidcarve {
namespace {

using Attribute = Mesh::Attribute;
using Element = PlyHeader::Element;
using Property = PlyHeader::Property;
using Type = Attribute::Type;
using openvdb::Vec3d;

/// Whether an integer type holds a number exactly.
bool is_one_of(Type type, double number) {
    const double most = full_intensity(type),
                 least = type == Type::int8 || type == Type::int16 || type == Type::int32
                             ? -most - 1
                             : 0;
    return number == std::floor(number) && number >= least && number <= most;
}

/// Properties that form one attribute.
struct Group {
    const char* name;
    std::vector<std::string> parts;
};
const std::vector<Group>& groups() {
    static const std::vector<Group> out = {{"normal", {"nx", "ny", "nz"}},
                                           {"colour", {"red", "green", "blue", "alpha"}},
                                           {"colour", {"red", "green", "blue"}},
                                           {"uv", {"s", "t"}},
                                           {"uv", {"u", "v"}},
                                           {"uv", {"texture_u", "texture_v"}}};
    return out;
}

bool is_axis(const Property& property) {
    return !property.count &&
           (property.name == "x" || property.name == "y" || property.name == "z");
}
bool is_corners(const Property& property) {
    return property.count && (property.name == "vertex_indices" || property.name == "vertex_index");
}

/// Reads a PLY file: header, vertices, faces, other elements.
class PlyReader {
public:
    PlyReader(FileText& file, Losses& losses) : file_(file), losses_(losses) { read_header(); }

    Mesh read() {
        for (const auto& element : elements_) {
            if (element.name == "vertex") read_vertices(element);
            else if (element.name == "face") read_faces(element);
            else skip(element);
        }
        require_vertices(file_, mesh_);
        mesh_.stored = stored_;
        return std::move(mesh_);
    }

private:
    void read_header() {
        if (!file_.next() || file_.line() != "ply")
            file_.fault("this is no PLY file: its first line is not 'ply'");
        PlyHeader header;
        for (auto kind = PlyStatement::Kind::comment; kind != PlyStatement::Kind::end;) {
            if (!file_.next()) file_.fault("the header has no 'end_header'");
            const auto statement = header.take(file_.line());
            require(statement, header);
            kind = statement.kind;
        }
        file_.rest_of_line();
        if (!header.encoding) file_.fault("the header states no format");
        encoding_ = *header.encoding;
        elements_ = std::move(header.elements);
        stored_->format = "ply";
        stored_->binary = encoding_ != NumberForm::ascii;
        stored_->big_endian = encoding_ == NumberForm::big;
        for (auto& comment : header.comments) stored_->lines.push_back({0, std::move(comment)});
        require_size();
        const auto named = [&](const char* name) {
            return std::ranges::count_if(elements_,
                                         [&](const Element& each) { return each.name == name; });
        };
        if (named("vertex") != 1 || named("face") > 1)
            file_.fault_in_all("a mesh has one element 'vertex' and at most one 'face'");
        if (named("tristrips") > 0)
            file_.fault_in_all("faces in strips can't be read; export polygons");
    }

    void require(const PlyStatement& statement, const PlyHeader& header) const {
        using Kind = PlyStatement::Kind;
        if (statement.kind == Kind::other && !statement.words.empty())
            file_.fault(fmt::format("{} does not belong into a header", quoted(statement.word(0))));
        if (statement.kind == Kind::format && statement.wrong)
            file_.fault(fmt::format("{} is no format of PLY", quoted(*statement.wrong)));
        if (statement.kind == Kind::element && statement.wrong) {
            file_.whole_number(*statement.wrong);
            file_.fault(fmt::format("{} is no count", quoted(*statement.wrong)));
        }
        if (statement.kind != Kind::property) return;
        if (header.elements.empty()) file_.fault("a property needs an element before it");
        const auto& property = header.elements.back().properties.back();
        if (statement.wrong)
            file_.fault(fmt::format("{} is no type of numbers", quoted(*statement.wrong)));
        if (property.count && is_floating(*property.count))
            file_.fault("a list is counted in whole numbers");
        if (property.name.empty()) file_.fault("a property needs a name");
    }

    /// Checks that the file has at least the bytes that its header promises.
    void require_size() const {
        std::size_t left = file_.left() + 1;  // the last line of a text file may have no line end
        for (const auto& element : elements_) {
            const auto each = element.bytes(!stored_->binary);
            if (each > 0 && element.count > left / each)
                file_.fault_in_all(
                    fmt::format("the header promises {} entries of '{}', for which the file is too "
                                "short: it is cut off or damaged",
                                element.count, element.name));
            if (each == 0 && element.count > 0)
                file_.fault_in_all(fmt::format("element '{}' has no properties", element.name));
            left -= each * element.count;
        }
    }

    double next(Type type) {
        if (!stored_->binary) return file_.number(file_.any_word());
        return number_in(file_.take(bytes_of(type)).data(), type, is_swapped(encoding_));
    }

    std::size_t next_count(const Property& list) {
        const double count = next(*list.count);
        const auto most = (file_.rest().size() + file_.line().size() + 1) /
                          (stored_->binary ? bytes_of(list.type) : 2);
        if (!(count >= 0 && count == std::floor(count) && count <= static_cast<double>(most)))
            file_.fault_in_all(
                fmt::format("a list '{}' of {} entries can't be: the file is cut off or damaged",
                            list.name, count));
        return static_cast<std::size_t>(count);
    }

    /// The attributes of an element, and the attribute and part of each of its properties.
    struct Columns {
        std::vector<Attribute> attributes;
        std::vector<std::pair<std::size_t, std::size_t>> places;
    };

    /// Groups the properties of an element into attributes.
    /// @param taken  true for properties that are not attributes
    Columns columns(const Element& element, Attribute::On on, bool (*taken)(const Property&)) {
        Columns out;
        const auto& all = element.properties;
        out.places.resize(all.size());
        for (std::size_t n = 0; n < all.size();) {
            if (taken(all[n])) {
                ++n;
                continue;
            }
            if (all[n].count) {
                losses_.push_back(fmt::format("the list '{}' of element '{}' is left out",
                                              all[n].name, element.name));
                ++n;
                continue;
            }
            Attribute attribute{all[n].name, on, {all[n].name}, all[n].type, {}, {}};
            for (const auto& group : groups()) {
                const auto size = group.parts.size();
                bool whole = n + size <= all.size();
                for (std::size_t part = 0; whole && part < size; ++part)
                    whole = all[n + part].name == group.parts[part] &&
                            all[n + part].type == all[n].type && !all[n + part].count;
                if (!whole) continue;
                attribute.name = group.name;
                attribute.parts = group.parts;
                break;
            }
            for (std::size_t part = 0; part < attribute.parts.size(); ++part)
                out.places[n++] = {out.attributes.size(), part};
            attribute.values.reserve(element.count * attribute.parts.size());
            out.attributes.push_back(std::move(attribute));
        }
        return out;
    }

    void finish(Columns& columns) {
        for (auto& attribute : columns.attributes) mesh_.attributes.push_back(std::move(attribute));
    }

    void read_vertices(const Element& element) {
        auto into = columns(element, Attribute::On::vertices, is_axis);
        std::array<std::size_t, 3> place{};
        for (std::size_t c = 0; c < 3; ++c) {
            const auto found = std::ranges::find_if(element.properties, [&](const Property& each) {
                return each.name == std::string(1, "xyz"[c]) && !each.count;
            });
            if (found == element.properties.end())
                file_.fault_in_all(fmt::format("element 'vertex' has no property '{}'", "xyz"[c]));
            place[c] = static_cast<std::size_t>(found - element.properties.begin());
            // Coordinates of different types are written as float64.
            stored_->number =
                c == 0 || stored_->number == found->type ? found->type : Type::float64;
        }
        mesh_.points.resize(element.count);
        for (std::size_t n = 0; n < element.count; ++n)
            for (std::size_t p = 0; p < element.properties.size(); ++p) {
                const auto& property = element.properties[p];
                if (property.count) {
                    for (auto left = next_count(property); left > 0; --left) next(property.type);
                    continue;
                }
                const double value = next(property.type);
                const auto axis = std::ranges::find(place, p) - place.begin();
                if (axis < 3) {
                    if (!std::isfinite(value))
                        file_.fault_in_all(fmt::format(
                            "vertex {} (counted from 0) is not at a finite place: its {} is {}", n,
                            "xyz"[axis], value));
                    mesh_.points[n][static_cast<int>(axis)] = value;
                } else if (!is_axis(property)) {
                    into.attributes[into.places[p].first].values.push_back(value);
                }
            }
        finish(into);
    }

    void read_faces(const Element& element) {
        if (std::ranges::count_if(element.properties, is_corners) != 1 && element.count > 0)
            file_.fault_in_all("element 'face' has no list 'vertex_indices'");
        auto into = columns(element, Attribute::On::faces, is_corners);
        for (std::size_t n = 0; n < element.count; ++n)
            for (std::size_t p = 0; p < element.properties.size(); ++p) {
                const auto& property = element.properties[p];
                if (!property.count) {
                    into.attributes[into.places[p].first].values.push_back(next(property.type));
                    continue;
                }
                const auto count = next_count(property);
                for (std::size_t corner = 0; corner < count; ++corner) {
                    const double vertex = next(property.type);
                    if (!is_corners(property)) continue;
                    if (!(vertex >= 0 && vertex < Attribute::none && vertex == std::floor(vertex)))
                        file_.fault_in_all(
                            fmt::format("face {} (counted from 0) has a vertex {}", n, vertex));
                    mesh_.corners.push_back(static_cast<std::uint32_t>(vertex));
                }
                if (!is_corners(property)) continue;
                if (count < 3)
                    file_.fault_in_all(fmt::format(
                        "face {} (counted from 0) has {} corners; it needs at least three", n,
                        count));
                mesh_.ends.push_back(mesh_.corners.size());
            }
        finish(into);
    }

    void skip(const Element& element) {
        for (std::size_t n = 0; n < element.count; ++n)
            for (const auto& property : element.properties)
                for (auto left = property.count ? next_count(property) : 1; left > 0; --left)
                    next(property.type);
        if (element.count > 0)
            losses_.push_back(fmt::format("element '{}' with {} entries is left out", element.name,
                                          element.count));
    }

    FileText& file_;
    Losses& losses_;
    Mesh mesh_;
    std::shared_ptr<Mesh::StoredForm> stored_ = std::make_shared<Mesh::StoredForm>();
    NumberForm encoding_ = NumberForm::ascii;
    std::vector<Element> elements_;
};

/// Writes a mesh as PLY, text or binary.
class Writer {
public:
    Writer(const Mesh& mesh, const std::vector<Vec3d>& points, Losses& losses)
        : mesh_(mesh), points_(points) {
        const bool own = mesh.stored && mesh.stored->format == "ply";
        if (own)
            encoding_ = !mesh.stored->binary      ? NumberForm::ascii
                        : mesh.stored->big_endian ? NumberForm::big
                                                  : NumberForm::little;
        const auto all = [&](const auto& holds) {
            return std::ranges::all_of(points, [&](const Vec3d& at) {
                return holds(at[0]) && holds(at[1]) && holds(at[2]);
            });
        };
        if (own && (is_floating(mesh.stored->number) ||
                    all([&](double c) { return is_one_of(mesh.stored->number, c); })))
            number_ = mesh.stored->number;
        else
            number_ = all([](double c) { return static_cast<double>(static_cast<float>(c)) == c; })
                          ? Type::float32
                          : Type::float64;
        for (const auto& attribute : mesh.attributes) {
            if (attribute.on != Attribute::On::corners) {
                kept_.push_back(attribute);
                continue;
            }
            std::size_t several = 0;
            if (auto single = per_vertex(mesh, attribute, several))
                kept_.push_back(std::move(*single));
            else
                lose(losses, attribute,
                     fmt::format(".ply holds one per vertex, and {} {} several or corners without",
                                 several, several == 1 ? "vertex has" : "vertices have"));
        }
        const auto& lines = lines_for(mesh, "ply", losses);
        put_header(lines);
    }

    std::string text() {
        for (std::size_t n = 0; n < points_.size(); ++n) {
            for (int c = 0; c < 3; ++c) put(number_, points_[n][c]);
            put_attributes(Attribute::On::vertices, n);
        }
        for (std::size_t n = 0; n < mesh_.faces(); ++n) {
            const auto face = mesh_.face(n);
            put(many_ ? Type::int32 : Type::uint8, static_cast<double>(face.size()));
            for (const auto vertex : face) put(large_ ? Type::uint32 : Type::int32, vertex);
            put_attributes(Attribute::On::faces, n);
        }
        return std::move(text_);
    }

private:
    void put_header(const std::vector<Mesh::Line>& lines) {
        std::vector<std::string> comments, statements;
        for (const auto& line : lines)
            if (!is_provenance_comment(line.text)) comments.push_back(line.text);
        const auto properties = [&](Attribute::On on) {
            for (const auto& attribute : kept_)
                for (const auto& part : attribute.parts)
                    if (attribute.on == on)
                        statements.push_back(
                            fmt::format("property {} {}", name_of(attribute.type), part));
        };
        statements.push_back(fmt::format("element vertex {}", points_.size()));
        for (const char axis : {'x', 'y', 'z'})
            statements.push_back(fmt::format("property {} {}", name_of(number_), axis));
        properties(Attribute::On::vertices);
        for (std::size_t n = 0; n < mesh_.faces(); ++n) many_ = many_ || mesh_.face(n).size() > 255;
        large_ = points_.size() > 0x7fffffff;
        statements.push_back(fmt::format("element face {}", mesh_.faces()));
        statements.push_back(fmt::format("property list {} {} vertex_indices",
                                         many_ ? "int" : "uchar", large_ ? "uint" : "int"));
        properties(Attribute::On::faces);
        text_ = ply_header_text(encoding_, comments, statements);
    }

    void put_attributes(Attribute::On on, std::size_t n) {
        for (const auto& attribute : kept_)
            if (attribute.on == on)
                for (const double value : attribute.entry(n)) put(attribute.type, value);
        if (encoding_ == NumberForm::ascii) text_.back() = '\n';
    }

    void put(Type type, double value) {
        if (encoding_ == NumberForm::ascii) fmt::format_to(std::back_inserter(text_), "{} ", value);
        else put_number(text_, value, type, is_swapped(encoding_));
    }

    const Mesh& mesh_;
    const std::vector<Vec3d>& points_;
    std::vector<Attribute> kept_;
    std::string text_;
    Type number_ = Type::float32;
    NumberForm encoding_ = NumberForm::little;
    bool many_ = false;   ///< a face has more corners than a byte can count
    bool large_ = false;  ///< an index is larger than an int
};

}  // namespace

Mesh read_ply(FileText& file, Losses& losses) { return PlyReader(file, losses).read(); }

void probe_ply(FileText& file) {
    Losses none;
    PlyReader(file, none);
}

std::string ply_text(const Mesh& mesh, const std::vector<Vec3d>& points, Losses& losses) {
    return Writer(mesh, points, losses).text();
}

}  // namespace fluidcarve
