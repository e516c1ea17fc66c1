#include "formats/geometry_file/obj.h"
#include "formats/geometry_file/provenance_comments.h"
#include "formats/mesh_file/mesh_formats.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>

namespace fluidcarve {
namespace {

using Attribute = Mesh::Attribute;
using openvdb::Vec3d;

/// Statements that do not change the geometry: they are kept as lines, at their place between the
/// faces.
constexpr std::array kept = {"g",        "o",        "s",          "mg",       "usemtl",
                             "mtllib",   "usemap",   "maplib",     "lod",      "bevel",
                             "c_interp", "d_interp", "shadow_obj", "trace_obj"};

/// Reads an OBJ file, statement by statement.
class ObjReader {
public:
    explicit ObjReader(FileText& file) : file_(file) {}

    Mesh read() {
        bool any = false;
        while (file_.next()) any = take(file_.word()) || any;
        if (!any) file_.fault_in_all("this is no OBJ file: there is no statement in it");
        for (std::size_t n = 0; n < mesh_.corners.size(); ++n)
            require(mesh_.corners[n], mesh_.points.size(), n, "vertex", "vertices");
        add("uv", uvs_, {"s", "t", "r"});
        add("normal", normals_, {"nx", "ny", "nz"});
        if (const auto width = extra_.width(); width > 0) {
            std::vector<std::string> colour{"red", "green", "blue", "alpha"};
            colour.resize(width);
            mesh_.attributes.push_back({width == 1 ? "weight" : "colour",
                                        Attribute::On::vertices,
                                        width == 1 ? std::vector<std::string>{"w"} : colour,
                                        Attribute::Type::float64,
                                        std::move(extra_.values),
                                        {}});
        }
        stored_->format = "obj";
        stored_->number = Attribute::Type::float64;
        mesh_.stored = stored_;
        return std::move(mesh_);
    }

private:
    /// The entries of `vt` or `vn`, which corners refer to by index.
    struct Pool {
        std::vector<double> values;
        std::vector<std::uint32_t> at;  ///< entry of each corner
        std::optional<std::size_t> numbers;
        std::size_t width() const { return numbers.value_or(0); }
        std::size_t size() const { return width() == 0 ? 0 : values.size() / width(); }
    };

    bool take(std::string_view keyword) {
        if (keyword.empty()) return false;
        if (keyword.starts_with('#')) return keep(), false;
        if (file_.line().ends_with('\\'))
            file_.fault(
                "a statement that is continued in the next line, by a '\\' at the end, can't be "
                "read; join the lines");
        if (keyword == "v") return take_vertex(), true;
        if (keyword == "vt") return take_tuple(uvs_, 1, 3), true;
        if (keyword == "vn") return take_tuple(normals_, 3, 3), true;
        if (keyword == "f") return take_face(), true;
        if (keyword == "l" || keyword == "p") return take_line(), true;
        if (std::ranges::find(kept, keyword) == kept.end())
            file_.fault(fmt::format(
                "{} is no statement that can be kept: a mesh is made of v, vt, vn, f, l and p",
                quoted(keyword)));
        return keep(), true;
    }

    void keep() {
        stored_->lines.push_back({mesh_.faces(), std::string(file_.line())});
        if (mesh_.points.empty() && uvs_.values.empty() && normals_.values.empty())
            stored_->head = stored_->lines.size();
    }

    void take_vertex() {
        Vec3d point;
        for (int c = 0; c < 3; ++c) {
            const auto word = file_.word('#');
            if (word.empty()) file_.fault("a vertex needs three numbers");
            point[c] = file_.number(word);
        }
        mesh_.points.push_back(point);
        take_tuple(extra_, 0, 4);
        if (extra_.width() == 2)
            file_.fault(
                "a vertex has three numbers, a fourth that is its weight, or a colour of three or "
                "four behind the three; not five");
    }

    void take_tuple(Pool& pool, std::size_t least, std::size_t most) {
        std::size_t numbers = 0;
        for (auto word = file_.word('#'); !word.empty(); word = file_.word('#'), ++numbers) {
            if (numbers == most)
                file_.fault(
                    fmt::format("these are more than {} numbers", most + (least == 0 ? 3 : 0)));
            pool.values.push_back(file_.number(word));
        }
        if (numbers < least) file_.fault(fmt::format("at least {} numbers are needed here", least));
        if (pool.numbers.value_or(numbers) != numbers)
            file_.fault("there are not as many numbers as in the statements before of its kind");
        pool.numbers = numbers;
    }

    /// The index from 0 of an entry, which may follow later.
    std::uint32_t index(std::string_view word, std::size_t size) const {
        const auto out = obj_index(file_.whole_number(word), size);
        if (!out || *out >= Attribute::none)
            file_.fault(fmt::format("{} is none of the {} above", quoted(word), size));
        return static_cast<std::uint32_t>(*out);
    }

    void take_face() {
        const auto first = mesh_.corners.size();
        for (auto word = file_.word('#'); !word.empty(); word = file_.word('#')) {
            std::array<std::string_view, 3> parts;
            for (std::size_t n = 0; !word.empty(); ++n) {
                if (n == 3) file_.fault("a corner has at most three indices, as in 1/2/3");
                const auto end = word.find('/');
                parts[n] = word.substr(0, end);
                word.remove_prefix(end == std::string_view::npos ? word.size() : end + 1);
            }
            if (parts[0].empty()) file_.fault("a corner needs a vertex");
            mesh_.corners.push_back(index(parts[0], mesh_.points.size()));
            uvs_.at.push_back(parts[1].empty() ? Attribute::none : index(parts[1], uvs_.size()));
            normals_.at.push_back(parts[2].empty() ? Attribute::none
                                                   : index(parts[2], normals_.size()));
        }
        if (mesh_.corners.size() - first < 3) file_.fault("a face needs at least three corners");
        mesh_.ends.push_back(mesh_.corners.size());
    }

    /// Keeps a statement of lines or points as text. Its indices must stay valid in a file where
    /// all vertices come first.
    void take_line() {
        for (auto word = file_.word('#'); !word.empty(); word = file_.word('#')) {
            const auto slash = word.find('/');
            const auto vertex = word.substr(0, slash);
            if (file_.whole_number(vertex) < 0)
                file_.fault(fmt::format(
                    "{} counts back from the last vertex, which can't be kept in lines and points",
                    quoted(vertex)));
            if (slash != std::string_view::npos && file_.whole_number(word.substr(slash + 1)) < 0)
                file_.fault(
                    fmt::format("{} counts back from the last UV, which can't be kept in lines",
                                quoted(word.substr(slash + 1))));
            if (index(vertex, mesh_.points.size()) >= mesh_.points.size())
                file_.fault(fmt::format("{} is none of the {} vertices above", quoted(vertex),
                                        mesh_.points.size()));
        }
        keep();
    }

    void require(std::uint32_t index, std::size_t size, std::size_t corner, const std::string& one,
                 const std::string& all) const {
        if (index == Attribute::none || index < size) return;
        const auto face = std::ranges::upper_bound(mesh_.ends, corner) - mesh_.ends.begin();
        file_.fault_in_all(fmt::format("face {} has {} {}, but there are {} {}", face + 1, one,
                                       std::uint64_t{index} + 1, size, all));
    }

    void add(const std::string& name, Pool& pool, std::vector<std::string> parts) {
        for (std::size_t n = 0; n < pool.at.size(); ++n)
            require(pool.at[n], pool.size(), n, name, name + "s");
        if (pool.size() == 0) return;
        parts.resize(pool.width());
        mesh_.attributes.push_back({name, Attribute::On::corners, std::move(parts),
                                    Attribute::Type::float64, std::move(pool.values),
                                    std::move(pool.at)});
    }

    FileText& file_;
    Mesh mesh_;
    std::shared_ptr<Mesh::StoredForm> stored_ = std::make_shared<Mesh::StoredForm>();
    Pool uvs_{}, normals_{}, extra_{};
};

/// The attributes that an OBJ file holds; null: none.
struct ObjAttributes {
    const Attribute *uvs = nullptr, *normals = nullptr;
    const Attribute* extra = nullptr;  ///< numbers behind the position of a vertex
};

ObjAttributes obj_attributes(const Mesh& mesh, Losses& losses) {
    ObjAttributes out;
    const bool own = mesh.stored && mesh.stored->format == "obj";
    for (const auto& attribute : mesh.attributes) {
        const auto parts = attribute.parts.size();
        // Weights of other formats have another meaning, and UVs of other formats must have two
        // parts.
        const bool is_extra = attribute.name == "colour"
                                  ? parts == 3 || parts == 4
                                  : attribute.name == "weight" && parts == 1 && own;
        if (attribute.name == "uv" && (parts == 2 || own) && !out.uvs) out.uvs = &attribute;
        else if (attribute.name == "normal" && parts == 3 && !out.normals) out.normals = &attribute;
        else if (attribute.on == Attribute::On::vertices && is_extra && !out.extra)
            out.extra = &attribute;
        else lose(losses, attribute, fmt::format(".obj holds none of {}", to_text(attribute.on)));
    }
    return out;
}

/// Writes an OBJ file.
class ObjWriter {
public:
    /// @param lines  kept statements
    ObjWriter(const Mesh& mesh, const ObjAttributes& attributes,
              const std::vector<Mesh::Line>& lines)
        : mesh_(mesh), attributes_(attributes), line_(lines.begin()), end_(lines.end()) {
        if (!lines.empty())
            put_lines(lines.begin() + static_cast<std::ptrdiff_t>(mesh.stored->head));
    }

    void put_vertices(const std::vector<Vec3d>& points) {
        const auto* const extra = attributes_.extra;
        const double light = extra ? full_intensity(extra->type) : 1;
        for (std::size_t n = 0; n < points.size(); ++n) {
            fmt::format_to(to_, "v {} {} {}", points[n].x(), points[n].y(), points[n].z());
            if (extra)
                for (const double part : extra->entry(n)) fmt::format_to(to_, " {}", part / light);
            text_.push_back('\n');
        }
        put_pool(attributes_.uvs, "vt");
        put_pool(attributes_.normals, "vn");
    }
    void put_faces() {
        for (std::size_t face = 0, corner = 0; face < mesh_.faces(); ++face) {
            put_lines_before(face);
            text_.push_back('f');
            for (; corner < mesh_.ends[face]; ++corner) put_corner(face, corner);
            text_.push_back('\n');
        }
        put_lines_before(mesh_.faces());
    }
    std::string end() {
        // An empty file would look truncated.
        if (text_.size() == 0) fmt::format_to(to_, "o nothing\n");
        return fmt::to_string(text_);
    }

private:
    using LineIterator = std::vector<Mesh::Line>::const_iterator;

    void put_lines(LineIterator end) {
        for (; line_ != end; ++line_)
            if (!is_provenance_comment(line_->text)) fmt::format_to(to_, "{}\n", line_->text);
    }
    void put_lines_before(std::size_t face) {
        put_lines(
            std::find_if(line_, end_, [&](const Mesh::Line& each) { return each.face > face; }));
    }
    void put_pool(const Attribute* pool, const char* keyword) {
        for (std::size_t n = 0; pool && n < pool->entries(); ++n)
            fmt::format_to(to_, "{} {}\n", keyword, fmt::join(pool->entry(n), " "));
    }
    void put_corner(std::size_t face, std::size_t corner) {
        const auto vertex = mesh_.corners[corner];
        const auto entry = [&](const Attribute* of) {
            return of ? Mesh::entry_of(*of, face, corner, vertex) : Attribute::none;
        };
        const auto uv = entry(attributes_.uvs), normal = entry(attributes_.normals);
        fmt::format_to(to_, " {}", std::uint64_t{vertex} + 1);
        if (uv != Attribute::none) fmt::format_to(to_, "/{}", std::uint64_t{uv} + 1);
        if (normal != Attribute::none)
            fmt::format_to(to_, "{}{}", uv != Attribute::none ? "/" : "//",
                           std::uint64_t{normal} + 1);
    }

    const Mesh& mesh_;
    const ObjAttributes attributes_;
    LineIterator line_;
    const LineIterator end_;
    fmt::memory_buffer text_;
    const std::back_insert_iterator<fmt::memory_buffer> to_ = std::back_inserter(text_);
};

}  // namespace

Mesh read_obj(FileText& file, Losses&) { return ObjReader(file).read(); }

std::string obj_text(const Mesh& mesh, const std::vector<Vec3d>& points, Losses& losses) {
    const auto& lines = lines_for(mesh, "obj", losses);
    ObjWriter out(mesh, obj_attributes(mesh, losses), lines);
    out.put_vertices(points);
    out.put_faces();
    return out.end();
}

}  // namespace fluidcarve
