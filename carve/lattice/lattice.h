#pragma once

#include "carve/lattice/form.h"

#include <openvdb/Types.h>

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// The dimension of a lattice that is carved. A seam takes one entry of each column: along `w` an
/// entry is a plane of the rig, along `t` a frame of the sequence.
enum class Axis { u = 0, v = 1, w = 2, t = 3 };

/// "u", "v", "w" or "t".
std::string to_text(Axis axis);
/// The axis along which frames are sampled for seams along `axis`. Seams of frames sample columns
/// of u; turned.h swaps u and time later.
constexpr Axis sampled_axis(Axis axis) { return axis == Axis::t ? Axis::u : axis; }
/// Index of a carved axis in a vertex's coordinates `(i, j, k)`; not for `t`.
constexpr std::size_t dimension(Axis axis) { return static_cast<std::size_t>(axis); }
/// Indices of the other two dimensions; for `t` those of u. The columns of a slice stand side by
/// side along the lateral dimension, and slices follow each other along the slice dimension.
constexpr std::size_t lateral_dimension(Axis axis) { return sampled_axis(axis) == Axis::u ? 1 : 0; }
constexpr std::size_t slice_dimension(Axis axis) { return axis == Axis::w ? 1 : 2; }
/// A vertex `(i, j, k)` by its entry along the carved axis and its column.
template <class T>
constexpr std::array<T, 3> vertex_of(Axis axis, T entry, T lateral, T slice) {
    std::array<T, 3> out{};
    out[dimension(axis)] = entry;
    out[lateral_dimension(axis)] = lateral;
    out[slice_dimension(axis)] = slice;
    return out;
}

/// Largest number of vertices along a dimension. Seam entries have 16 bits and need one more
/// value, for the entry behind the last vertex.
constexpr int most_vertices = 65534;

/// A grid of `I x J x K` vertices `(i, j, k)` along a rig of planes: the uniform space in which
/// seams are found and carved (paper 3.1). `i` runs along `u`, `j` along `v`, `k` from plane to
/// plane (`w`). A dimension may have a single vertex. Around a rig, `u` is the distance from it,
/// and `v` goes around it (polar.h).
struct Lattice {
    struct Plane {
        openvdb::Vec3d origin;   ///< world position of vertex (0, 0, k); around a rig, of all
                                 ///< vertices (0, j, k)
        openvdb::Vec3d u, v, w;  ///< directions, of length 1; in a box, steps to the next vertex in
                                 ///< spacings, which may differ in length
    };

    std::array<int, 3> shape{};  ///< I, J, K
    double spacing = 0;        ///< distance of neighbouring vertices, world units; in a box along u
    bool closed = false;       ///< plane K-1 is followed by plane 0; needs at least 3 planes
    bool around = false;       ///< u and v go around the rig: vertex j = J-1 is followed by j = 0
    bool closed_form = false;  ///< positions are located by the paper's eq. 3, not by the true
                               ///< inverse of position()
    std::vector<Plane> planes;  ///< `[k]`
    std::string description;    ///< what the lattice was made from, for messages
    std::string hash;           ///< lattice_hash(); identifies the lattice that seams belong to

    LatticeForm form() const { return {shape, closed, around}; }
    /// Whether the lattice is a straight box, upright or slanted: open, all planes share their
    /// directions and stand `spacing * w` apart.
    bool is_box() const;
    /// World position of a vertex (paper eq. 2) or of a point between vertices, trilinear in its
    /// cell. Continues straight beyond rims and open ends. In a closed lattice `w` and `w + K` are
    /// the same place, around a rig `v` and `v + J`; there `u` and `v` are polar within a plane.
    /// @param at  lattice index coordinates (u, v, w), in vertices
    openvdb::Vec3d position(const openvdb::Vec3d& at) const;
};

/// Extends a lattice before its first vertices, and by planes behind its last one. Planes added
/// along w continue straight, one spacing apart. Vertices added before the first shift the
/// existing indices up.
/// @param below   number of added vertices along u, v and w; around a rig none along u and v, in a
///   closed lattice none along w
/// @param behind  number of planes added behind the last one
Lattice extended(const Lattice& lattice, const std::array<int, 3>& below, int behind);

/// Prefix of a lattice hash. A seam file of another tool may state a hash without it.
inline constexpr std::string_view lattice_hash_prefix = "xxh3-64:";

/// Hash over all fields of a lattice except its description, at full precision: the prefix and 16
/// hex digits.
std::string lattice_hash(const Lattice& lattice);

/// Makes a straight lattice, with description and hash.
/// @param first    world position of vertex (0, 0, 0)
/// @param shape    I, J, K, each at least 1
/// @param spacing  world units, above 0
/// @param axes     world axes (0, 1, 2) of u, v and w
Lattice make_box(const openvdb::Vec3d& first, const std::array<int, 3>& shape, double spacing,
                 const std::array<int, 3>& axes);

/// Makes a straight lattice with the given steps, with description and hash.
/// @param steps  from a vertex to the next along u, v and w, world units; not in one plane
Lattice make_box(const openvdb::Vec3d& first, const std::array<int, 3>& shape,
                 const std::array<openvdb::Vec3d, 3>& steps);

}  // namespace fluidcarve
