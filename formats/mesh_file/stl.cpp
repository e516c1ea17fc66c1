#include "carve/base/saturated.h"
#include "carve/mesh/triangles.h"
#include "formats/mesh_file/mesh_formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <iterator>
#include <optional>
#include <unordered_map>

namespace fluidcarve {
namespace {

using Attribute = Mesh::Attribute;
using openvdb::Vec3d;

constexpr std::size_t head_bytes = 80, triangle_bytes = 50;
/// Type of the last two bytes of a binary triangle.
constexpr auto extra_type = Attribute::Type::uint16;

template <class T>
T little_endian(const char* bytes) {
    static_assert(std::endian::native == std::endian::little);
    T out;
    std::memcpy(&out, bytes, sizeof(T));
    return out;
}

/// The number of triangles that a binary file states; nothing if it is a text file.
/// @throws Failure if it is truncated
std::optional<std::size_t> triangles_of(const FileText& file) {
    const auto all = file.rest();
    const std::size_t size = file.left(), head = head_bytes + 4;
    const std::size_t count =
        size < head ? 0 : little_endian<std::uint32_t>(all.data() + head_bytes);
    const bool whole = size >= head && (size - head) / triangle_bytes >= count;
    if (all.starts_with("solid") && (!whole || all.find("endsolid") != std::string_view::npos))
        return std::nullopt;
    if (size < head)
        file.fault_in_all(
            "this is no STL file: it neither begins with 'solid' nor has the head of a binary one");
    if (!whole)
        file.fault_in_all(
            fmt::format("the head promises {} triangles, for which the file is too short: it is "
                        "cut off, damaged, or no STL file",
                        count));
    return count;
}

/// Collects triangles, and merges corners with equal positions to one vertex, since STL has no
/// shared vertices.
class Triangles {
public:
    void add(const std::array<Vec3d, 3>& corners, const Vec3d& normal) {
        for (const auto& corner : corners) {
            const auto [found, fresh] =
                vertices_.try_emplace(corner, static_cast<std::uint32_t>(mesh.points.size()));
            if (fresh) mesh.points.push_back(corner);
            mesh.corners.push_back(found->second);
        }
        mesh.ends.push_back(mesh.corners.size());
        normals.values.insert(normals.values.end(), normal.asPointer(), normal.asPointer() + 3);
    }

    Mesh mesh;
    Attribute normals{
        "normal", Attribute::On::faces, {"nx", "ny", "nz"}, Attribute::Type::float32, {}, {}};

private:
    struct Hash {
        std::size_t operator()(const Vec3d& p) const {
            std::size_t out = 0;
            // Adding 0 turns -0 into 0: both are the same position.
            for (int c = 0; c < 3; ++c)
                out = (out ^ std::bit_cast<std::uint64_t>(p[c] + 0.0)) * 0x9E3779B97F4A7C15u;
            return out ^ out >> 32;
        }
    };
    struct Same {
        bool operator()(const Vec3d& a, const Vec3d& b) const {
            return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
        }
    };
    std::unordered_map<Vec3d, std::uint32_t, Hash, Same> vertices_;
};

void read_binary(FileText& file, std::size_t count, Triangles& out, Mesh::StoredForm& stored,
                 Losses& losses) {
    stored.binary = true;
    stored.lines.push_back({0, std::string(file.take(head_bytes))});
    file.take(4);
    Attribute extra{"attribute", Attribute::On::faces, {"attribute"}, extra_type, {}, {}};
    bool says = false;
    for (std::size_t n = 0; n < count; ++n) {
        const auto bytes = file.take(triangle_bytes);
        std::array<Vec3d, 4> parts;
        for (std::size_t p = 0; p < 4; ++p)
            for (std::size_t c = 0; c < 3; ++c)
                parts[p][static_cast<int>(c)] =
                    little_endian<float>(bytes.data() + 4 * (3 * p + c));
        for (std::size_t p = 1; p < 4; ++p)
            if (!parts[p].isFinite())
                file.fault_in_all(fmt::format(
                    "triangle {} (counted from 0) has a corner that is not at a finite place", n));
        out.add({parts[1], parts[2], parts[3]}, parts[0]);
        extra.values.push_back(little_endian<std::uint16_t>(bytes.data() + 48));
        says = says || extra.values.back() != 0;
    }
    if (says) out.mesh.attributes.push_back(std::move(extra));
    if (!file.rest().empty())
        losses.push_back(
            fmt::format("{} bytes behind the last triangle are left out", file.rest().size()));
}

/// Reads the solids of a text file.
class StlReader {
public:
    StlReader(FileText& file, Triangles& out, Mesh::StoredForm& stored)
        : file_(file), out_(out), stored_(stored) {
        out_.normals.type = Attribute::Type::float64;
    }

    void read() {
        for (auto word = next_word(); !word.empty(); word = next_word()) take(word);
        if (open_) file_.fault("the file ends without 'endsolid': it is cut off");
    }

private:
    /// The next word, if need be of a later line; empty at the end of the file.
    std::string_view next_word() {
        auto word = file_.word();
        while (word.empty() && file_.next()) word = file_.word();
        return word;
    }
    void take(std::string_view word) {
        if (word == "solid" && !open_) {
            open_ = true;
            stored_.lines.push_back({out_.mesh.faces(), std::string(file_.rest_of_line())});
        } else if (word == "endsolid" && open_) {
            open_ = false;
            file_.rest_of_line();
        } else if (word == "facet" && open_) {
            take_facet();
        } else {
            file_.fault(fmt::format("{} should stand here, not {}",
                                    open_ ? "'facet' or 'endsolid'" : "'solid'", quoted(word)));
        }
    }
    void take_facet() {
        expect("normal");
        Vec3d normal;
        // Normals of triangles without an area may be nan.
        for (int c = 0; c < 3; ++c) normal[c] = file_.any_number(file_.any_word());
        expect("outer");
        expect("loop");
        std::array<Vec3d, 3> corners;
        for (auto& corner : corners) {
            expect("vertex");
            for (int c = 0; c < 3; ++c) corner[c] = file_.number(file_.any_word());
        }
        expect("endloop");
        expect("endfacet");
        out_.add(corners, normal);
    }
    void expect(std::string_view wanted) {
        if (const auto word = file_.any_word(); word != wanted)
            file_.fault(fmt::format("'{}' should stand here, not {}", wanted, quoted(word)));
    }

    FileText& file_;
    Triangles& out_;
    Mesh::StoredForm& stored_;
    bool open_ = false;  ///< within a solid
};

/// The attributes that an STL file holds; null: none.
struct StlAttributes {
    const Attribute *normals = nullptr, *extra = nullptr;
};

StlAttributes stl_attributes(const Mesh& mesh, bool text, Losses& losses) {
    StlAttributes out;
    for (const auto& attribute : mesh.attributes) {
        const bool on_faces = attribute.on == Attribute::On::faces;
        if (on_faces && attribute.name == "normal" && attribute.parts.size() == 3 && !out.normals)
            out.normals = &attribute;
        else if (on_faces && attribute.name == "attribute" && attribute.type == extra_type &&
                 !text && !out.extra)
            out.extra = &attribute;
        else lose(losses, attribute, ".stl holds nothing but triangles and their normals");
    }
    return out;
}

/// Adds which faces are written as triangles, and which vertices are not written.
void lose_shapes(const Mesh& mesh, std::size_t vertices, Losses& losses) {
    std::size_t polygons = 0;
    std::vector<bool> used(vertices);
    for (std::size_t n = 0; n < mesh.faces(); ++n) {
        polygons += mesh.face(n).size() > 3;
        for (const auto vertex : mesh.face(n)) used[vertex] = true;
    }
    const auto alone = std::ranges::count(used, false);
    if (polygons > 0)
        losses.push_back(fmt::format(
            "{} faces of more than three corners are written as triangles: .stl has no others",
            polygons));
    if (alone > 0)
        losses.push_back(
            fmt::format("{} vertices without a face are not written: .stl has none", alone));
}

/// Writes an STL file, as text or binary.
class StlWriter {
public:
    StlWriter(bool text, const std::vector<Mesh::Line>& lines)
        : text_(text), line_(lines.begin()), end_(lines.end()) {}

    /// @param comment  for a binary file
    void put_head(const std::string& comment, const Mesh& mesh) {
        if (text_) return;
        out_ = comment;
        out_.resize(head_bytes, '\0');
        std::size_t triangles = 0;
        for (std::size_t n = 0; n < mesh.faces(); ++n) triangles += mesh.face(n).size() - 2;
        put(static_cast<std::uint32_t>(triangles));
    }
    /// Begins the solids of a text file that stand before a face.
    void begin_solids(std::size_t face) {
        for (; text_ && line_ != end_ && line_->face <= face; ++line_) {
            if (open_) out_ += "endsolid\n";
            fmt::format_to(std::back_inserter(out_), "solid{}{}\n", line_->text.empty() ? "" : " ",
                           line_->text);
            open_ = true;
        }
    }
    void put_triangle(const std::array<Vec3d, 3>& corners, const Vec3d& normal,
                      std::uint16_t extra) {
        put_three("facet normal", normal);
        if (text_) out_ += "outer loop\n";
        for (const auto& corner : corners) put_three("vertex", corner);
        if (text_) out_ += "endloop\nendfacet\n";
        else put(extra);
    }
    std::string end() {
        if (text_) out_ += "endsolid\n";
        return std::move(out_);
    }

private:
    template <class Value>
    void put(Value value) {
        const auto bytes = std::bit_cast<std::array<char, sizeof(value)>>(value);
        out_.append(bytes.data(), bytes.size());
    }
    void put_three(const char* keyword, const Vec3d& three) {
        if (text_)
            fmt::format_to(std::back_inserter(out_), "{} {} {} {}\n", keyword, three[0], three[1],
                           three[2]);
        else
            for (int c = 0; c < 3; ++c) put(static_cast<float>(three[c]));
    }

    const bool text_;
    std::vector<Mesh::Line>::const_iterator line_, end_;
    bool open_ = false;  ///< within a solid
    std::string out_;
};

Vec3d normal_of(const std::array<Vec3d, 3>& corners) {
    auto out = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    if (const double length = out.length(); length > 0) out /= length;
    return out;
}

}  // namespace

void probe_stl(FileText& file) { triangles_of(file); }

Mesh read_stl(FileText& file, Losses& losses) {
    auto stored = std::make_shared<Mesh::StoredForm>();
    stored->format = "stl";
    Triangles out;
    if (const auto count = triangles_of(file)) read_binary(file, *count, out, *stored, losses);
    else StlReader(file, out, *stored).read();
    out.mesh.attributes.insert(out.mesh.attributes.begin(), std::move(out.normals));
    out.mesh.stored = std::move(stored);
    return std::move(out.mesh);
}

std::string stl_text(const Mesh& mesh, const std::vector<Vec3d>& points, Losses& losses) {
    const bool own = mesh.stored && mesh.stored->format == "stl",
               text = own && !mesh.stored->binary;
    const auto [normals, extra] = stl_attributes(mesh, text, losses);
    const auto& lines = lines_for(mesh, "stl", losses);
    lose_shapes(mesh, points.size(), losses);

    StlWriter out(text, lines);
    out.put_head(own && !lines.empty() ? lines.front().text : "fluidcarve", mesh);
    std::vector<std::array<std::uint32_t, 3>> parts;
    for (std::size_t n = 0; n < mesh.faces(); ++n) {
        out.begin_solids(n);
        triangulate(points, mesh.face(n), parts);
        const auto attribute = saturated<std::uint16_t>(extra ? extra->entry(n)[0] : 0);
        for (const auto& part : parts) {
            const std::array corners{points[part[0]], points[part[1]], points[part[2]]};
            out.put_triangle(
                corners, normals ? Vec3d(normals->entry(n).data()) : normal_of(corners), attribute);
        }
    }
    out.begin_solids(mesh.faces());
    return out.end();
}

}  // namespace fluidcarve
