#include "carve/mesh/triangles.h"
#include "formats/mesh_file/formats.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstring>
#include <iterator>
#include <unordered_map>

namespace fluidcarve {
namespace {

using Attribute = Mesh::Attribute;
using openvdb::Vec3d;

constexpr std::size_t head_bytes = 80, triangle_bytes = 50;
constexpr auto extra_type =
    Attribute::Type::uint16;  ///< type of the last two bytes of a binary triangle

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

void read_text(FileText& file, Triangles& out, Mesh::StoredForm& stored) {
    out.normals.type = Attribute::Type::float64;
    const auto expect = [&](std::string_view wanted) {
        if (const auto word = file.any_word(); word != wanted)
            file.fault(fmt::format("'{}' should stand here, not {}", wanted, quoted(word)));
    };
    const auto position = [&] {
        Vec3d out;
        for (int c = 0; c < 3; ++c) out[c] = file.number(file.any_word());
        return out;
    };
    // Normals of triangles without an area may be nan.
    const auto direction = [&] {
        Vec3d out;
        for (int c = 0; c < 3; ++c) out[c] = file.any_number(file.any_word());
        return out;
    };
    bool open = false;
    for (;;) {
        auto word = file.word();
        while (word.empty() && file.next()) word = file.word();
        if (word.empty()) break;
        if (word == "solid" && !open) {
            open = true;
            stored.lines.push_back({out.mesh.faces(), std::string(file.rest_of_line())});
        } else if (word == "endsolid" && open) {
            open = false;
            file.rest_of_line();
        } else if (word == "facet" && open) {
            expect("normal");
            const auto normal = direction();
            expect("outer");
            expect("loop");
            std::array<Vec3d, 3> corners;
            for (auto& corner : corners) {
                expect("vertex");
                corner = position();
            }
            expect("endloop");
            expect("endfacet");
            out.add(corners, normal);
        } else {
            file.fault(fmt::format("{} should stand here, not {}",
                                   open ? "'facet' or 'endsolid'" : "'solid'", quoted(word)));
        }
    }
    if (open) file.fault("the file ends without 'endsolid': it is cut off");
}

}  // namespace

void probe_stl(FileText& file) { triangles_of(file); }

Mesh read_stl(FileText& file, Losses& losses) {
    auto stored = std::make_shared<Mesh::StoredForm>();
    stored->format = "stl";
    Triangles out;
    if (const auto count = triangles_of(file)) read_binary(file, *count, out, *stored, losses);
    else read_text(file, out, *stored);
    out.mesh.attributes.insert(out.mesh.attributes.begin(), std::move(out.normals));
    out.mesh.stored = std::move(stored);
    return std::move(out.mesh);
}

std::string stl_text(const Mesh& mesh, const std::vector<Vec3d>& points, Losses& losses) {
    const bool own = mesh.stored && mesh.stored->format == "stl",
               text = own && !mesh.stored->binary;
    const Attribute *normals = nullptr, *extra = nullptr;
    for (const auto& attribute : mesh.attributes) {
        const bool on_faces = attribute.on == Attribute::On::faces;
        if (on_faces && attribute.name == "normal" && attribute.parts.size() == 3 && !normals)
            normals = &attribute;
        else if (on_faces && attribute.name == "attribute" && attribute.type == extra_type &&
                 !text && !extra)
            extra = &attribute;
        else lose(losses, attribute, ".stl holds nothing but triangles and their normals");
    }
    const auto& lines = lines_for(mesh, "stl", losses);
    std::size_t polygons = 0, triangles = 0, alone = 0;
    std::vector<bool> used(points.size());
    for (std::size_t n = 0; n < mesh.faces(); ++n) {
        polygons += mesh.face(n).size() > 3;
        triangles += mesh.face(n).size() - 2;
        for (const auto vertex : mesh.face(n)) used[vertex] = true;
    }
    for (const bool each : used) alone += !each;
    if (polygons > 0)
        losses.push_back(fmt::format(
            "{} faces of more than three corners are written as triangles: .stl has no others",
            polygons));
    if (alone > 0)
        losses.push_back(
            fmt::format("{} vertices without a face are not written: .stl has none", alone));

    std::string out;
    auto to = std::back_inserter(out);
    if (!text) {
        out = own && !lines.empty() ? lines.front().text : "fluidcarve";
        out.resize(head_bytes, '\0');
    }
    const auto put = [&](const auto value) {
        const auto bytes = std::bit_cast<std::array<char, sizeof(value)>>(value);
        out.append(bytes.data(), bytes.size());
    };
    if (!text) put(static_cast<std::uint32_t>(triangles));
    const auto put_three = [&](const char* keyword, const Vec3d& three) {
        if (text) fmt::format_to(to, "{} {} {} {}\n", keyword, three[0], three[1], three[2]);
        else
            for (int c = 0; c < 3; ++c) put(static_cast<float>(three[c]));
    };
    auto line = lines.begin();
    bool open = false;
    std::vector<std::array<std::uint32_t, 3>> parts;
    const auto begin_solids = [&](std::size_t face) {
        for (; text && line != lines.end() && line->face <= face; ++line) {
            if (open) out += "endsolid\n";
            fmt::format_to(to, "solid{}{}\n", line->text.empty() ? "" : " ", line->text);
            open = true;
        }
    };
    for (std::size_t n = 0; n < mesh.faces(); ++n) {
        begin_solids(n);
        triangulate(points, mesh.face(n), parts);
        for (const auto& part : parts) {
            const auto &a = points[part[0]], &b = points[part[1]], &d = points[part[2]];
            auto normal = (b - a).cross(d - a);
            if (const double length = normal.length(); length > 0) normal /= length;
            if (normals) normal = Vec3d(normals->entry(n).data());
            put_three("facet normal", normal);
            if (text) out += "outer loop\n";
            for (const auto* const corner : {&a, &b, &d}) put_three("vertex", *corner);
            if (text) out += "endloop\nendfacet\n";
            else put(static_cast<std::uint16_t>(extra ? extra->entry(n)[0] : 0));
        }
    }
    begin_solids(mesh.faces());
    if (text) out += "endsolid\n";
    return out;
}

}  // namespace fluidcarve
