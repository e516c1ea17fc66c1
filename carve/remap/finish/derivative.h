#pragma once

#include "carve/lattice/mapping.h"
#include "carve/seam/carve_map.h"
#include "carve/seam/smooth_displacement.h"

#include <openvdb/math/Mat3.h>

#include <optional>
#include <vector>

namespace fluidcarve {

/// The derivative of `g`, world units per vertex; column n is along u, v or w. `g` is linear along
/// u and v, and along w from plane to plane.
/// @param at  lattice index coordinates
openvdb::Mat3d position_slope(const Mapping& mapping, const openvdb::Vec3d& at);

/// The derivative of a carve as a map `psi` from output positions to the input positions that they
/// come from:
/// `psi = g o M1 o ... o Mn o f`. It uses the displacements of SmoothDisplacement, since those of
/// the seams jump.
class CarveDerivative {
public:
    /// Both parameters must outlive this object.
    /// @param mapping  with the extent map.reach()
    CarveDerivative(const Mapping& mapping, const CarveMap& map);

    /// The derivative at a point, world units per world unit, by the chain rule. With the paper's
    /// closed form, it is computed as if `f` were the inverse of `g`.
    /// @param at  carved lattice coordinates within the mapping's extent
    /// @return nothing where the derivative is exactly the identity: where nothing moves, and in a
    ///   straight box wherever displacements are equal. Also nothing where a removal frees the
    ///   point
    std::optional<openvdb::Mat3d> operator()(const openvdb::Vec3d& at) const {
        const auto image = this->image(at);
        return image ? std::optional(image->derivative) : std::nullopt;
    }

    /// The source of a point, and how the space around it is compressed or stretched.
    struct Image {
        openvdb::Vec3d source;      ///< lattice coordinates before the carve
        openvdb::Mat3d slope;       ///< derivative of `source`, in lattice coordinates
        openvdb::Mat3d derivative;  ///< world units per world unit
    };
    /// The derivative with its parts; nothing where operator() returns nothing.
    std::optional<Image> image(const openvdb::Vec3d& at) const;

    /// Whether the carve itself uses these displacements, so that Image::source is where values
    /// come from: if all steps are soft.
    bool exact() const;
    const Mapping& mapping() const { return mapping_; }

    /// Box of carved lattice coordinates outside which there is no derivative.
    openvdb::BBoxd range() const { return map_.whole(); }

private:
    const Mapping& mapping_;
    const CarveMap& map_;
    std::vector<SmoothDisplacement> smooth_;  ///< `[step]`
};

}  // namespace fluidcarve
