#pragma once

#include "nodes/io/origin.h"

#include <openvdb/Types.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fluidcarve {

/// Polygons in world space, as their file had them: faces of any number of corners, in its order, and all that it says of
/// vertices, faces and corners. Nothing is merged, split or turned; an animated mesh is delivered per frame.
struct Mesh {
    /// Numbers of vertices, faces or corners.
    struct Attribute {
        enum class On { vertices, faces, corners };
        enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
        static constexpr std::uint32_t none = ~std::uint32_t{0};

        std::string name;  ///< "uv", "normal", "colour", or the file's own
        On on = On::vertices;
        std::vector<std::string> parts;  ///< what PLY calls its numbers: "nx", "ny", "nz"
        Type type = Type::float32;       ///< colours reach to an integer type's maximum, others to 1
        std::vector<double> values;      ///< parts.size() per entry; an entry per vertex or face, in their order
        std::vector<std::uint32_t> at;   ///< on corners: each corner's entry, or `none`; entries may be shared

        std::size_t entries() const { return values.size() / parts.size(); }
        std::span<const double> entry(std::size_t n) const { return {values.data() + n * parts.size(), parts.size()}; }
    };

    /// A line of its file that stands before a face: a group, a material, a comment.
    struct Line {
        std::size_t face;  ///< the number of faces: at the end
        std::string text;
    };

    /// What a writer needs to give back what came in.
    struct Origin {
        std::string format;  ///< "obj", "ply", "off" or "stl"
        bool binary = false, big_endian = false;
        Attribute::Type number = Attribute::Type::float32;  ///< of coordinates, in binary files and PLY's header
        std::vector<Line> lines;                            ///< by face, rising
        std::size_t head = 0;                               ///< how many of them stand before all vertices
        Placement placement;
        std::vector<openvdb::Vec3d> in_file;  ///< positions before the placement; empty if it moves nothing
    };

    std::vector<openvdb::Vec3d> points;
    std::vector<std::uint32_t> corners;  ///< the vertex of each, one face after the other
    std::vector<std::size_t> ends;       ///< per face, where its corners end in `corners`
    std::vector<Attribute> attributes;
    std::shared_ptr<const Origin> origin;  ///< null: made by a node

    std::size_t faces() const { return ends.size(); }
    std::size_t begin(std::size_t face) const { return face == 0 ? 0 : ends[face - 1]; }
    std::span<const std::uint32_t> face(std::size_t n) const { return {corners.data() + begin(n), ends[n] - begin(n)}; }
    void add_face(std::span<const std::uint32_t> vertices) {
        corners.insert(corners.end(), vertices.begin(), vertices.end());
        ends.push_back(corners.size());
    }
    /// The first attribute of this name, or null.
    const Attribute* find(const std::string& name) const;
    /// Which entry of an attribute a corner has, or Attribute::none.
    static std::uint32_t entry_of(const Attribute& attribute, std::size_t face, std::size_t corner, std::uint32_t vertex) {
        return attribute.on == Attribute::On::corners ? attribute.at[corner] : attribute.on == Attribute::On::faces ? static_cast<std::uint32_t>(face) : vertex;
    }
};

/// The mesh in the shot's world, its file's numbers kept.
/// @param mesh  of a file, with an origin
Mesh placed(Mesh mesh, const Placement& placement);
/// Positions in the file's space again: the file's own numbers where a vertex has not moved.
/// @param placement  to undo instead; null: the origin's
std::vector<openvdb::Vec3d> unplaced(const Mesh& mesh, const Placement* placement);

/// The attribute with an entry per vertex, if all corners of each vertex have equal ones; vertices without a corner get 0.
/// @param attribute  on corners
/// @param several    becomes the number of vertices with several entries, or corners without one
std::optional<Mesh::Attribute> per_vertex(const Mesh& mesh, const Mesh::Attribute& attribute, std::size_t& several);

}  // namespace fluidcarve
