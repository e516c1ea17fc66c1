#include "nodes/mesh/formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <type_traits>

namespace fluidcarve {
namespace {

using Attribute = Mesh::Attribute;
using Type = Attribute::Type;
using openvdb::Vec3d;

/// Names of a PLY type, old and new, and its size in bytes.
struct TypeName {
    std::string_view name, other;
    Type type;
    std::size_t bytes;
};
constexpr std::array types = {TypeName{"char", "int8", Type::int8, 1},        TypeName{"uchar", "uint8", Type::uint8, 1},
                              TypeName{"short", "int16", Type::int16, 2},     TypeName{"ushort", "uint16", Type::uint16, 2},
                              TypeName{"int", "int32", Type::int32, 4},       TypeName{"uint", "uint32", Type::uint32, 4},
                              TypeName{"float", "float32", Type::float32, 4}, TypeName{"double", "float64", Type::float64, 8}};
const TypeName& name_of(Type type) { return types[static_cast<std::size_t>(type)]; }

bool is_integer(Type type) { return type != Type::float32 && type != Type::float64; }
/// Whether an integer type holds a number exactly.
bool is_one_of(Type type, double number) {
    const double most = full_light(type), least = type == Type::int8 || type == Type::int16 || type == Type::int32 ? -most - 1 : 0;
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

/// A property declared in a PLY header.
struct Property {
    std::string name;
    Type type;
    std::optional<Type> count;  ///< for a list: type of its length

    bool is_axis() const { return !count && (name == "x" || name == "y" || name == "z"); }
    bool is_corners() const { return count && (name == "vertex_indices" || name == "vertex_index"); }
};
/// An element declared in a PLY header.
struct Element {
    std::string name;
    std::size_t count;
    std::vector<Property> properties;

    /// Minimum size of an entry in a file, bytes.
    std::size_t bytes(bool binary) const {
        std::size_t out = 0;
        for (const auto& property : properties) out += !binary ? 2 : name_of(property.count.value_or(property.type)).bytes;
        return out;
    }
};

template <class T>
double as(const char* bytes, bool swap) {
    std::array<char, sizeof(T)> copy;
    std::memcpy(copy.data(), bytes, sizeof(T));
    if (swap) std::reverse(copy.begin(), copy.end());
    return static_cast<double>(std::bit_cast<T>(copy));
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
        mesh_.origin = origin_;
        return std::move(mesh_);
    }

private:
    Type type(std::string_view word) const {
        const auto found = std::find_if(types.begin(), types.end(), [&](const TypeName& each) { return each.name == word || each.other == word; });
        if (found == types.end()) file_.fault(fmt::format("{} is no type of numbers", quoted(word)));
        return found->type;
    }

    void read_header() {
        if (!file_.next() || file_.line() != "ply") file_.fault("this is no PLY file: its first line is not 'ply'");
        origin_->format = "ply";
        bool stated = false;
        for (;;) {
            if (!file_.next()) file_.fault("the header has no 'end_header'");
            const auto keyword = file_.word();
            if (keyword == "end_header") break;
            if (keyword == "comment" || keyword == "obj_info") origin_->lines.push_back({0, std::string(file_.line())});
            else if (keyword == "format") stated = true, read_format(file_.word());
            else if (keyword == "element") read_element();
            else if (keyword == "property") read_property();
            else if (!keyword.empty()) file_.fault(fmt::format("{} does not belong into a header", quoted(keyword)));
        }
        if (!stated) file_.fault("the header states no format");
        std::size_t left = file_.left() + 1;  // the last line of a text file may have no line end
        for (const auto& element : elements_) {
            const auto each = element.bytes(origin_->binary);
            if (each > 0 && element.count > left / each)
                file_.fault_in_all(fmt::format("the header promises {} entries of '{}', for which the file is too short: it is cut off or damaged",
                                               element.count, element.name));
            if (each == 0 && element.count > 0) file_.fault_in_all(fmt::format("element '{}' has no properties", element.name));
            left -= each * element.count;
        }
        const auto named = [&](const char* name) {
            return std::count_if(elements_.begin(), elements_.end(), [&](const Element& each) { return each.name == name; });
        };
        if (named("vertex") != 1 || named("face") > 1) file_.fault_in_all("a mesh has one element 'vertex' and at most one 'face'");
        if (named("tristrips") > 0) file_.fault_in_all("faces in strips can't be read; export polygons");
    }

    void read_format(std::string_view word) {
        origin_->binary = word != "ascii";
        origin_->big_endian = word == "binary_big_endian";
        if (origin_->binary && !origin_->big_endian && word != "binary_little_endian") file_.fault(fmt::format("{} is no format of PLY", quoted(word)));
    }

    void read_element() {
        const auto name = file_.word(), count = file_.word();
        const auto entries = file_.whole(count);
        if (entries < 0) file_.fault(fmt::format("{} is no count", quoted(count)));
        elements_.push_back({std::string(name), static_cast<std::size_t>(entries), {}});
    }

    void read_property() {
        if (elements_.empty()) file_.fault("a property needs an element before it");
        auto word = file_.word();
        std::optional<Type> count;
        if (word == "list") {
            count = type(file_.word());
            if (*count == Type::float32 || *count == Type::float64) file_.fault("a list is counted in whole numbers");
            word = file_.word();
        }
        const auto of = type(word);
        const auto name = file_.word();
        if (name.empty()) file_.fault("a property needs a name");
        elements_.back().properties.push_back({std::string(name), of, count});
    }

    double next(Type type) {
        if (!origin_->binary) return file_.number(file_.any_word());
        const auto bytes = file_.take(name_of(type).bytes);
        const bool swap = origin_->big_endian != (std::endian::native == std::endian::big);
        switch (type) {
            case Type::int8: return as<std::int8_t>(bytes.data(), swap);
            case Type::uint8: return as<std::uint8_t>(bytes.data(), swap);
            case Type::int16: return as<std::int16_t>(bytes.data(), swap);
            case Type::uint16: return as<std::uint16_t>(bytes.data(), swap);
            case Type::int32: return as<std::int32_t>(bytes.data(), swap);
            case Type::uint32: return as<std::uint32_t>(bytes.data(), swap);
            case Type::float32: return as<float>(bytes.data(), swap);
            case Type::float64: break;
        }
        return as<double>(bytes.data(), swap);
    }

    std::size_t next_count(const Property& list) {
        const double count = next(*list.count);
        const auto most = (file_.rest().size() + file_.line().size() + 1) / (origin_->binary ? name_of(list.type).bytes : 2);
        if (!(count >= 0 && count == std::floor(count) && count <= static_cast<double>(most)))
            file_.fault_in_all(fmt::format("a list '{}' of {} entries can't be: the file is cut off or damaged", list.name, count));
        return static_cast<std::size_t>(count);
    }

    /// The attributes of an element, and the attribute and part of each of its properties.
    struct Columns {
        std::vector<Attribute> attributes;
        std::vector<std::pair<std::size_t, std::size_t>> places;
    };

    /// Groups the properties of an element into attributes. @param taken  true for properties that are not attributes
    Columns columns(const Element& element, Attribute::On on, bool (Property::*taken)() const) {
        Columns out;
        const auto& all = element.properties;
        out.places.resize(all.size());
        for (std::size_t n = 0; n < all.size();) {
            if ((all[n].*taken)()) {
                ++n;
                continue;
            }
            if (all[n].count) {
                losses_.push_back(fmt::format("the list '{}' of element '{}' is left out", all[n].name, element.name));
                ++n;
                continue;
            }
            Attribute attribute{all[n].name, on, {all[n].name}, all[n].type, {}, {}};
            for (const auto& group : groups()) {
                const auto size = group.parts.size();
                bool whole = n + size <= all.size();
                for (std::size_t part = 0; whole && part < size; ++part)
                    whole = all[n + part].name == group.parts[part] && all[n + part].type == all[n].type && !all[n + part].count;
                if (!whole) continue;
                attribute.name = group.name;
                attribute.parts = group.parts;
                break;
            }
            for (std::size_t part = 0; part < attribute.parts.size(); ++part) out.places[n++] = {out.attributes.size(), part};
            attribute.values.reserve(element.count * attribute.parts.size());
            out.attributes.push_back(std::move(attribute));
        }
        return out;
    }

    void finish(Columns& columns) {
        for (auto& attribute : columns.attributes) mesh_.attributes.push_back(std::move(attribute));
    }

    void read_vertices(const Element& element) {
        auto into = columns(element, Attribute::On::vertices, &Property::is_axis);
        std::array<std::size_t, 3> place{};
        for (std::size_t c = 0; c < 3; ++c) {
            const auto found = std::find_if(element.properties.begin(), element.properties.end(),
                                            [&](const Property& each) { return each.name == std::string(1, "xyz"[c]) && !each.count; });
            if (found == element.properties.end()) file_.fault_in_all(fmt::format("element 'vertex' has no property '{}'", "xyz"[c]));
            place[c] = static_cast<std::size_t>(found - element.properties.begin());
            // Coordinates of different types are written as float64.
            origin_->number = c == 0 || origin_->number == found->type ? found->type : Type::float64;
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
                const auto axis = std::find(place.begin(), place.end(), p) - place.begin();
                if (axis < 3) {
                    if (!std::isfinite(value))
                        file_.fault_in_all(fmt::format("vertex {} (counted from 0) is not at a finite place: its {} is {}", n, "xyz"[axis], value));
                    mesh_.points[n][static_cast<int>(axis)] = value;
                } else if (!property.is_axis()) {
                    into.attributes[into.places[p].first].values.push_back(value);
                }
            }
        finish(into);
    }

    void read_faces(const Element& element) {
        if (std::count_if(element.properties.begin(), element.properties.end(), std::mem_fn(&Property::is_corners)) != 1 && element.count > 0)
            file_.fault_in_all("element 'face' has no list 'vertex_indices'");
        auto into = columns(element, Attribute::On::faces, &Property::is_corners);
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
                    if (!property.is_corners()) continue;
                    if (!(vertex >= 0 && vertex < Attribute::none && vertex == std::floor(vertex)))
                        file_.fault_in_all(fmt::format("face {} (counted from 0) has a vertex {}", n, vertex));
                    mesh_.corners.push_back(static_cast<std::uint32_t>(vertex));
                }
                if (!property.is_corners()) continue;
                if (count < 3) file_.fault_in_all(fmt::format("face {} (counted from 0) has {} corners; it needs at least three", n, count));
                mesh_.ends.push_back(mesh_.corners.size());
            }
        finish(into);
    }

    void skip(const Element& element) {
        for (std::size_t n = 0; n < element.count; ++n)
            for (const auto& property : element.properties)
                for (auto left = property.count ? next_count(property) : 1; left > 0; --left) next(property.type);
        if (element.count > 0) losses_.push_back(fmt::format("element '{}' with {} entries is left out", element.name, element.count));
    }

    FileText& file_;
    Losses& losses_;
    Mesh mesh_;
    std::shared_ptr<Mesh::Origin> origin_ = std::make_shared<Mesh::Origin>();
    std::vector<Element> elements_;
};

/// Writes a mesh as PLY, text or binary.
class Writer {
public:
    Writer(const Mesh& mesh, const std::vector<Vec3d>& points, Losses& losses) : mesh_(mesh), points_(points) {
        const bool own = mesh.origin && mesh.origin->format == "ply";
        binary_ = !own || mesh.origin->binary;
        swap_ = own && mesh.origin->big_endian != (std::endian::native == std::endian::big);
        const auto all = [&](const auto& holds) {
            return std::all_of(points.begin(), points.end(), [&](const Vec3d& at) { return holds(at[0]) && holds(at[1]) && holds(at[2]); });
        };
        if (own && (!is_integer(mesh.origin->number) || all([&](double c) { return is_one_of(mesh.origin->number, c); }))) number_ = mesh.origin->number;
        else number_ = all([](double c) { return static_cast<double>(static_cast<float>(c)) == c; }) ? Type::float32 : Type::float64;
        for (const auto& attribute : mesh.attributes) {
            if (attribute.on != Attribute::On::corners) {
                kept_.push_back(attribute);
                continue;
            }
            std::size_t several = 0;
            if (auto single = per_vertex(mesh, attribute, several)) kept_.push_back(std::move(*single));
            else
                lose(losses, attribute,
                     fmt::format(".ply holds one per vertex, and {} {} several or corners without", several, several == 1 ? "vertex has" : "vertices have"));
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
        const bool big = swap_ == (std::endian::native == std::endian::little);
        auto to = std::back_inserter(text_);
        fmt::format_to(to, "ply\nformat {} 1.0\n", !binary_ ? "ascii" : big ? "binary_big_endian" : "binary_little_endian");
        for (const auto& line : lines) fmt::format_to(to, "{}\n", line.text);
        const auto properties = [&](Attribute::On on) {
            for (const auto& attribute : kept_)
                for (const auto& part : attribute.parts)
                    if (attribute.on == on) fmt::format_to(to, "property {} {}\n", name_of(attribute.type).name, part);
        };
        fmt::format_to(to, "element vertex {}\n", points_.size());
        for (const char axis : {'x', 'y', 'z'}) fmt::format_to(to, "property {} {}\n", name_of(number_).name, axis);
        properties(Attribute::On::vertices);
        for (std::size_t n = 0; n < mesh_.faces(); ++n) many_ = many_ || mesh_.face(n).size() > 255;
        large_ = points_.size() > 0x7fffffff;
        fmt::format_to(to, "element face {}\nproperty list {} {} vertex_indices\n", mesh_.faces(), many_ ? "int" : "uchar", large_ ? "uint" : "int");
        properties(Attribute::On::faces);
        text_ += "end_header\n";
    }

    void put_attributes(Attribute::On on, std::size_t n) {
        for (const auto& attribute : kept_)
            if (attribute.on == on)
                for (const double value : attribute.entry(n)) put(attribute.type, value);
        if (!binary_) text_.back() = '\n';
    }

    template <class T>
    void put_bytes(double value) {
        // Numbers read from text may be outside of the range of their type.
        if constexpr (std::is_integral_v<T>) value = std::clamp<double>(value, std::numeric_limits<T>::lowest(), std::numeric_limits<T>::max());
        auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(static_cast<T>(value));
        if (swap_) std::reverse(bytes.begin(), bytes.end());
        text_.append(bytes.data(), bytes.size());
    }

    void put(Type type, double value) {
        if (!binary_) {
            fmt::format_to(std::back_inserter(text_), "{} ", value);
            return;
        }
        switch (type) {
            case Type::int8: return put_bytes<std::int8_t>(value);
            case Type::uint8: return put_bytes<std::uint8_t>(value);
            case Type::int16: return put_bytes<std::int16_t>(value);
            case Type::uint16: return put_bytes<std::uint16_t>(value);
            case Type::int32: return put_bytes<std::int32_t>(value);
            case Type::uint32: return put_bytes<std::uint32_t>(value);
            case Type::float32: return put_bytes<float>(value);
            case Type::float64: return put_bytes<double>(value);
        }
    }

    const Mesh& mesh_;
    const std::vector<Vec3d>& points_;
    std::vector<Attribute> kept_;
    std::string text_;
    Type number_ = Type::float32;
    bool binary_ = false, swap_ = false;
    bool many_ = false;   ///< a face has more corners than a byte can count
    bool large_ = false;  ///< an index is larger than an int
};

}  // namespace

Mesh read_ply(FileText& file, Losses& losses) { return PlyReader(file, losses).read(); }

void probe_ply(FileText& file) {
    Losses none;
    PlyReader(file, none);
}

std::string ply_text(const Mesh& mesh, const std::vector<Vec3d>& points, Losses& losses) { return Writer(mesh, points, losses).text(); }

}  // namespace fluidcarve
