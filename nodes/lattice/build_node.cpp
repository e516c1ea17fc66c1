#include "nodes/lattice/build_node.h"

#include "nodes/lattice/lattice_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fluidcarve {

namespace {
enum class Inverse { exact, closed_form };
}  // namespace

template <>
struct ChoiceNames<Inverse> {
    static constexpr std::array names = {std::pair{"exact", Inverse::exact}, std::pair{"closed_form", Inverse::closed_form}};
};

namespace {

struct LatticeBuild : LatticeNode {
    struct Params : LatticeNode::Params {
        Interval extent_u, extent_v;
        bool flip_u = false;
        Inverse mapping = Inverse::exact;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (!(params.spacing > 0)) return check.fault("spacing", "'spacing' must be above 0");
        check_extent("extent_u", params.extent_u, params.spacing, check);
        check_extent("extent_v", params.extent_v, params.spacing, check);
    }

    static void foresee(const Params& params, Outlook& ahead) {
        const auto most = [](const Interval& extent) { return std::max(std::abs(extent.low), std::abs(extent.high)); };
        if (const auto* const rig = ahead.region("rig")) ahead.lies(widened(*rig, std::hypot(most(params.extent_u), most(params.extent_v))));
    }

    void add(const Params& params, const Ports& io, Context& context) { build(spec_of(params), io, context); }
    void finish(const Params& params, Ports&, Context& context) { conclude_build(spec_of(params), params.on_fold, context); }

private:
    static void check_extent(const char* name, const Interval& extent, double spacing, NodeCheck& check) {
        if (extent.high == extent.low)
            check.fault(name, fmt::format("'{}' is [{:g}, {:g}], which is empty; for a single vertex, as for images, state less than one spacing: [{:g}, {:g}]",
                                          name, extent.low, extent.high, extent.low, extent.low + spacing / 2));
        else if (const double count = vertices_along({extent.low, extent.high}, spacing); count > most_vertices)
            check.fault(name, fmt::format("'{}' holds {:.0f} vertices at a spacing of {:g}; {} is the most", name, count, spacing, most_vertices));
    }

    static LatticeSpec spec_of(const Params& params) {
        LatticeSpec out;
        out.spacing = params.spacing;
        out.u = {params.extent_u.low, params.extent_u.high};
        out.v = {params.extent_v.low, params.extent_v.high};
        out.flip_u = params.flip_u;
        out.closed_form = params.mapping == Inverse::closed_form;
        out.smooth = params.smooth;
        out.max_iterations = params.max_iterations;
        return out;
    }
};

}  // namespace

NodeType lattice_build() {
    using Params = LatticeBuild::Params;
    Declare<LatticeBuild> node(
        "lattice.build",
        "Builds a lattice along a rig. Its planes stand across the rig, at equal distances, and do not twist. A moving rig gets one lattice per frame, "
        "each with as many planes as the longest rig needs.");
    node.input("rig", &LatticeBuild::Ports::rig, "The path: static, or one per frame.")
        .required("spacing", &Params::spacing, Unit::world, at_least(0),
                  "Distance between neighbouring vertices, above 0. If in doubt, use the voxel size. On a closed rig, the distance between planes is adjusted "
                  "so that it fits a whole number of times.")
        .required("extent_u", &Params::extent_u, Unit::world, any_number(),
                  "Where the lattice begins and ends along `u`; 0 is the rig. The first vertex lies at the lower end, the last one at most at the upper end.")
        .required("extent_v", &Params::extent_v, Unit::world, any_number(),
                  "The same along `v`. On the first plane, `v` is the rig's `up`, made orthogonal to the rig.")
        .param("flip_u", &Params::flip_u,
               "Reverses `u`. Otherwise `u` is `v x w` (right-handed): it points outwards on a circle, and inwards on a loop that runs counter-clockwise seen "
               "from `up`.")
        .param("mapping", &Params::mapping,
               "How positions are located: by the true inverse, or, for comparison, by the paper's closed form and plane directions, which blur where planes "
               "turn.");
    return declare_lattice(node);
}

}  // namespace fluidcarve
