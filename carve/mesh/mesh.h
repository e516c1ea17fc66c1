#pragma once

#include "carve/base/numbers.h"
#include "carve/volume/stored_form.h"

#include <openvdb/Types.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fluidcarve {

/// A polygon mesh in world space: faces with any number of corners, with attributes of vertices,
/// faces and corners. Order and orientation of faces and vertices are those of the file. An
/// animated mesh is one Mesh per frame.
struct Mesh {
    /// Numbers attached to vertices, faces or corners.
    struct Attribute {
        enum class On { vertices, faces, corners };
        using Type = NumberType;
        static constexpr std::uint32_t none = ~std::uint32_t{0};

        std::string name;  ///< "uv", "normal", "colour", or the name in the file
        On on = On::vertices;
        std::vector<std::string> parts;  ///< names of its numbers in PLY: "nx", "ny", "nz"
        /// Colours: full intensity is the maximum of an integer type, or 1.
        Type type = Type::float32;
        /// `[entry][part]`; on vertices and faces, one entry each, in their order.
        std::vector<double> values;
        /// On corners: the entry of each corner, or `none`; corners may share entries.
        std::vector<std::uint32_t> at;

        std::size_t entries() const { return values.size() / parts.size(); }
        std::span<const double> entry(std::size_t n) const {
            return {values.data() + n * parts.size(), parts.size()};
        }
    };

    /// A line of the file between faces: a group, a material, a comment.
    struct Line {
        std::size_t face;  ///< index of the face after it; the number of faces: at the end
        std::string text;
    };

    /// How the mesh was stored in its file, so that a writer can write it back unchanged.
    struct StoredForm {
        std::string format;  ///< "obj", "ply", "off" or "stl"
        bool binary = false, big_endian = false;
        /// Type of coordinates, in binary files and PLY's header.
        Attribute::Type number = Attribute::Type::float32;
        std::vector<Line> lines;  ///< sorted by face
        std::size_t head = 0;     ///< number of lines before all vertices
        Placement placement;
        std::vector<openvdb::Vec3d> in_file;  ///< positions in the file, one per vertex; empty if
                                              ///< the placement moves nothing
    };

    std::vector<openvdb::Vec3d> points;  ///< vertex positions, world units
    std::vector<std::uint32_t> corners;  ///< vertex of each corner, face after face
    std::vector<std::size_t> ends;       ///< per face: end of its corners in `corners`
    std::vector<Attribute> attributes;
    std::shared_ptr<const StoredForm> stored;  ///< null: made by a node

    std::size_t faces() const { return ends.size(); }
    std::size_t begin(std::size_t face) const { return face == 0 ? 0 : ends[face - 1]; }
    std::span<const std::uint32_t> face(std::size_t n) const {
        return {corners.data() + begin(n), ends[n] - begin(n)};
    }
    void add_face(std::span<const std::uint32_t> vertices) {
        corners.insert(corners.end(), vertices.begin(), vertices.end());
        ends.push_back(corners.size());
    }
    /// The first attribute of this name, or null.
    const Attribute* find(const std::string& name) const;
    /// The entry of an attribute for a corner, or Attribute::none.
    /// @param corner  index in `corners`
    /// @param vertex  the corner's vertex
    static std::uint32_t entry_of(const Attribute& attribute, std::size_t face, std::size_t corner,
                                  std::uint32_t vertex) {
        return attribute.on == Attribute::On::corners ? attribute.at[corner]
               : attribute.on == Attribute::On::faces ? static_cast<std::uint32_t>(face)
                                                      : vertex;
    }
};

/// Moves a mesh from its file's space into the shot's world. Its stored form keeps the file's
/// positions.
/// @param mesh  read from a file, with a stored form
Mesh placed(Mesh mesh, const Placement& placement);
/// Vertex positions in the file's space; exactly those of the file where a vertex has not moved.
/// @param placement  the placement to undo; null: that of the stored form
/// @return one per vertex
std::vector<openvdb::Vec3d> unplaced(const Mesh& mesh, const Placement* placement);

/// Converts an attribute on corners to one on vertices, if the corners of each vertex have equal
/// entries. Vertices without corners get 0.
/// @param several  set to the number of vertices whose corners have different entries, or none
/// @return nothing if `several` is above 0
std::optional<Mesh::Attribute> per_vertex(const Mesh& mesh, const Mesh::Attribute& attribute,
                                          std::size_t& several);

}  // namespace fluidcarve
