#pragma once

#include <openvdb/Types.h>

#include <array>
#include <string>
#include <vector>

namespace fluidcarve {

/// Which dimension of a lattice is carved.
enum class Axis { u = 0, v = 1 };

/// The most vertices along a dimension: entries of seams have 16 bits, the entry behind the last included.
constexpr int most_vertices = 65534;

/// Vertices `(i, j, k)` along a rig of planes, `I x J x K` of them: the uniform space in which seams are found
/// and carved (paper 3.1). `i` runs along `u`, `j` along `v`, `k` from plane to plane. A dimension may be 1.
struct Lattice {
    struct Plane {
        openvdb::Vec3d origin;   ///< world position of vertex (0, 0, k)
        openvdb::Vec3d u, v, w;  ///< unit directions
    };

    std::array<int, 3> shape{};  ///< I, J, K
    double spacing = 0;          ///< distance of neighbouring vertices, world units
    bool closed = false;         ///< plane K-1 is followed by plane 0; never with fewer than 3 planes
    bool closed_form = false;    ///< positions are located by the paper's eq. 3 instead of the true inverse of `position`
    std::vector<Plane> planes;   ///< K of them
    std::string description;     ///< what it was made from, for people
    std::string hash;            ///< lattice_hash: seams belong to one lattice

    /// Whether all planes share their orthogonal directions and stand `spacing` apart along w: a straight box.
    bool is_box() const;
    /// World position of a vertex (paper eq. 2) or of a point between: trilinear in its cell's vertices. Goes on
    /// straight beyond the rims and the ends; in a closed lattice `w` and `w + K` are the same place.
    /// @param at  lattice index coordinates (u, v, w), in vertices
    openvdb::Vec3d position(const openvdb::Vec3d& at) const;
};

/// The lattice with so many vertices more before its first ones along u and v: the same vertices have higher indices.
Lattice extended_below(const Lattice& lattice, const std::array<int, 2>& vertices);

/// Sixteen hex digits over all fields of a lattice but its description, at full precision.
std::string lattice_hash(const Lattice& lattice);

/// A straight lattice, described and hashed.
/// @param first    world position of vertex (0, 0, 0)
/// @param shape    I, J, K, each at least 1
/// @param spacing  world units, above 0
/// @param axes     which world axes (0, 1, 2) are u, v and w
Lattice make_box(const openvdb::Vec3d& first, const std::array<int, 3>& shape, double spacing, const std::array<int, 3>& axes);

}  // namespace fluidcarve
