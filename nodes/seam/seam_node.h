#pragma once

#include "graph/node_type.h"
#include "nodes/field/same_transform.h"
#include "nodes/payloads.h"
#include "nodes/seam/find_seams.h"

#include <memory>
#include <optional>

namespace fluidcarve {

template <>
struct ChoiceNames<Axis> {
    static constexpr std::array names = {std::pair{"u", Axis::u}, std::pair{"v", Axis::v}};
};

/// What every solver node takes and gives (METHOD 8): a new solver is a FindSeam, its own parameters and
///
///     struct Mine : SeamNode {
///         struct Params : SeamNode::Params { int passes = 3; };
///         void finish(const Params& params, Ports& io, Context& context) { solve(params, io, context, my_seam...); }
///     };
///     NodeType seam_mine() {
///         Declare<Mine> node("seam.mine", "...");
///         return declare_solver(node).param("passes", &Mine::Params::passes, ...);
///     }
class SeamNode {
public:
    struct Params {
        Axis axis = Axis::u;
        Count count;
        Auto<Interval> window;
    };
    struct Ports {
        Ref<FloatGrid> energy;
        Ref<Lattice> lattice;
        Ref<Seams> seams;
    };

    static void check(const Params& params, NodeCheck& check);
    /// Takes one frame's energy at the lattice's vertices.
    void add(const Params& params, const Ports& io, Context& context);

protected:
    /// Finds the seams, reports them under `seams`: axis, kind, shape, and per seam energy and wall_s.
    void solve(const Params& params, Ports& io, Context& context, const FindSeam& find);

private:
    std::optional<EnergyVolume> energy_;
    OneTransform transform_;
    std::size_t added_ = 0;
    bool any_active_ = false;
    bool any_met_ = false;
    openvdb::BBoxd active_box_;  ///< world box of all frames' active voxels
};

/// The common inputs, parameters and output of a solver node.
template <class Node>
Declare<Node>& declare_solver(Declare<Node>& node) {
    using Params = SeamNode::Params;
    using Ports = SeamNode::Ports;
    return node.input("energy", &Ports::energy, "What seams avoid, 0 or more; sampled at the lattice's vertices.")
        .input("lattice", &Ports::lattice, "The space that is carved.")
        .param("axis", &Params::axis, "The dimension of the lattice that shrinks or grows.")
        .required("count", &Params::count, Unit::seams, any_number(), "Seams: negative removes, positive inserts; N% is of the vertices along the axis.")
        .param("window", &Params::window, Unit::vertices, at_least(0), "First and last vertex along the axis that seams may take; auto is all of them.")
        .output("seams", &Ports::seams, "The seams, in the order in which they were found.");
}

}  // namespace fluidcarve
