#pragma once

#include "nodes/lattice/mapping.h"
#include "nodes/remap/carve_map.h"

#include <openvdb/math/Mat3.h>

#include <optional>
#include <vector>

namespace fluidcarve {

/// A step's displacements, box-filtered along its axis (METHOD 5): over 2n + 1 entries, n the number of its seams, but
/// not beyond the first and the last entry, where fewer count, as many on both sides. So an end moves as far as before.
/// Scaled at the vertices where the map fades.
class SmoothDisplacement {
public:
    explicit SmoothDisplacement(const CarveStep& step);

    struct Value {
        double d;                 ///< vertices
        openvdb::Vec3d gradient;  ///< along u, v and w: central differences, one-sided at rims and open ends
    };
    /// Both trilinear between the vertices.
    /// @param at  carved lattice coordinates, inside the step's
    Value at(const openvdb::Vec3d& at) const;

private:
    double entry(int entry, int lateral, int k) const;

    int axis_, laterals_, slices_;
    bool closed_;
    int last_entry_;              ///< of the carved space
    int first_, last_;            ///< entries beyond which nothing changes along the axis
    std::vector<float> entries_;  ///< `[column][entry]`, first_ to last_
};

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
    std::optional<openvdb::Mat3d> operator()(const openvdb::Vec3d& at) const;

    /// A box of carved lattice coordinates outside which there is no derivative.
    openvdb::BBoxd range() const;

private:
    openvdb::Mat3d position_slope(const openvdb::Vec3d& at) const;

    const Mapping& mapping_;
    const CarveMap& map_;
    std::vector<SmoothDisplacement> smooth_;  ///< per step
};

}  // namespace fluidcarve
