#pragma once

#include "nodes/lattice/mapping.h"
#include "nodes/seams/carve_map.h"
#include "nodes/seams/smooth_displacement.h"

#include <openvdb/math/Mat3.h>

#include <optional>
#include <vector>

namespace fluidcarve {

/// The derivative of `g`: world units by vertices. `g` is linear along u and along v, and along w from plane to plane.
/// @param at  lattice index coordinates
openvdb::Mat3d position_slope(const Mapping& mapping, const openvdb::Vec3d& at);

/// The derivative of a carve as a map `psi` from positions in the output to those in the input that they come from,
/// `psi = g o M1 o ... o Mn o f`, with the displacements of SmoothDisplacement: those of the seams jump.
class CarveDerivative {
public:
    /// Both must outlive this.
    /// @param mapping  with the extent map.reach()
    CarveDerivative(const Mapping& mapping, const CarveMap& map);

    /// World units by world units, by the chain rule. In a lattice of the paper's closed form as if `f` were the inverse of `g`.
    /// @param at  carved lattice coordinates within the mapping's extent
    /// @return nothing where it is the identity to the last bit: away from all that moves, and in a straight box wherever
    ///   displacements are alike; nor where a removal frees the place
    std::optional<openvdb::Mat3d> operator()(const openvdb::Vec3d& at) const {
        const auto image = this->image(at);
        return image ? std::optional(image->derivative) : std::nullopt;
    }

    /// Where a place comes from, and how the space around it is pressed.
    struct Image {
        openvdb::Vec3d source;  ///< in the lattice before the carve
        openvdb::Mat3d slope;   ///< of `source`, lattice by lattice
        openvdb::Mat3d derivative;
    };
    /// The same with its parts; nothing where there is no derivative.
    std::optional<Image> image(const openvdb::Vec3d& at) const;

    /// Whether the carve itself goes by what is derived here, so that Image::source is where values come from: if all steps are soft.
    bool exact() const;
    const Mapping& mapping() const { return mapping_; }

    /// A box of carved lattice coordinates outside which there is no derivative.
    openvdb::BBoxd range() const;

private:
    const Mapping& mapping_;
    const CarveMap& map_;
    std::vector<SmoothDisplacement> smooth_;  ///< per step
};

}  // namespace fluidcarve
