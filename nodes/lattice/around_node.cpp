#include "nodes/lattice/around_node.h"

#include "nodes/lattice/lattice_node.h"

#include <fmt/format.h>

#include <cmath>

namespace fluidcarve {

namespace {

struct LatticeAround : LatticeNode {
    struct Params : LatticeNode::Params {
        double radius = 0;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (!(params.spacing > 0)) return check.fault("spacing", "'spacing' must be above 0");
        if (vertices_along({0, params.radius}, params.spacing) < 2)
            check.fault("radius", fmt::format("'radius' {:g} is less than the spacing, {:g}: nothing can be carved", params.radius, params.spacing));
        else if (const double most = params.spacing * most_vertices / (2 * M_PI); params.radius > most)
            check.fault("radius", fmt::format("'radius' {:g} takes more than {} vertices for a turn at a spacing of {:g}; {:.4g} is the most", params.radius,
                                              most_vertices, params.spacing, most));
    }

    static void foresee(const Params& params, Outlook& ahead) {
        if (const auto* const rig = ahead.region("rig")) ahead.lies(widened(*rig, params.radius));
    }

    void add(const Params& params, const Ports& io, Context& context) { build(spec_of(params), io, context); }
    void finish(const Params& params, Ports&, Context& context) { conclude_build(spec_of(params), params.on_fold, context); }

private:
    static LatticeSpec spec_of(const Params& params) {
        LatticeSpec out;
        out.spacing = params.spacing;
        out.u = {0, params.radius};
        out.around = true;
        out.smooth = params.smooth;
        out.max_iterations = params.max_iterations;
        return out;
    }
};

}  // namespace

NodeType lattice_around() {
    using Params = LatticeAround::Params;
    Declare<LatticeAround> node(
        "lattice.around",
        "Builds a lattice around a rig: `u` is the distance from the rig, and `v` runs around it and closes. Seams across `u` make a trail, a jet or a column "
        "of smoke thinner or thicker from all sides. A moving rig gets one lattice per frame, each with as many planes as the longest rig needs.");
    node.input("rig", &LatticeAround::Ports::rig, "The path through the middle of what is carved: static, or one per frame.")
        .required("spacing", &Params::spacing, Unit::world, at_least(0),
                  "Distance between neighbouring vertices along `u` and along the rig, above 0. If in doubt, use the voxel size. On a closed rig, the distance "
                  "between planes is adjusted so that it fits a whole number of times.")
        .required("radius", &Params::radius, Unit::world, at_least(0),
                  "How far the lattice reaches from the rig. It should hold the content: what lies beyond does not move. The outermost vertices stand one "
                  "spacing apart along `v`.");
    return declare_lattice(node);
}

}  // namespace fluidcarve
