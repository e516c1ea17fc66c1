#include "nodes/energy.h"

#include "carve/energy/combine.h"
#include "carve/energy/curvature.h"
#include "carve/energy/gradient.h"
#include "carve/energy/kinetic.h"
#include "carve/energy/remap.h"
#include "carve/energy/surface.h"
#include "carve/energy/volume.h"
#include "carve/energy/vorticity.h"
#include "carve/field/active_range.h"
#include "carve/field/collocate.h"
#include "carve/field/stencil.h"
#include "carve/volume/volume.h"
#include "graph/types/node_type.h"
#include "nodes/params/term_ranges.h"

#include <fmt/format.h>

#include <string>
#include <vector>

namespace fluidcarve {

namespace {

constexpr auto velocity_doc = "Velocity, world units per second; staggered grids are collocated.";
constexpr auto gain_doc = "Multiplier on the result.";
constexpr auto before_weighting = "of each term that is remapped to [0, 1] before weighting";

/// The doc string of `range`, of nodes that add energies.
/// @param interval  what the interval is, after "The interval "
/// @param order     of the terms in a list: empty, or ": " and their names
std::string range_doc(const char* interval, const char* order = "") {
    return fmt::format(
        "The interval {}; values outside are clamped. Auto: from the smallest to the largest "
        "active value of the sequence, found in an extra pass. A list states one interval or auto "
        "per term{}. A constant term counts as 0.",
        interval, order);
}

struct RangeParams {
    TermRanges range;
};

/// The base of nodes that add energies, each remapped to [0, 1] over the whole sequence:
/// `Node::terms(params, io, context)` makes them, and their ranges are set here.
template <class Node>
class EnergySum {
public:
    static NodeTraits traits(const RangeParams& params) {
        return {.gathers = params.range.gathers()};
    }
    static std::shared_ptr<FrameRanges> digest(const auto& params, const auto& io,
                                               Context& context) {
        std::vector<Ref<FloatGrid>> energies;
        for (const auto& term : Node::terms(params, io, context)) energies.push_back(term.energy);
        return ranges_of(params.range, energies);
    }
    void add(const RangeParams&, const Ref<FrameRanges>& frame, Context&) { gathered_.add(*frame); }
    void finish(const RangeParams&, auto&, Context&) {}
    void run(const auto& params, auto& io, Context& context) const {
        auto terms = Node::terms(params, io, context);
        for (std::size_t n = 0; n < terms.size(); ++n)
            terms[n].range = gathered_.of(params.range, n);
        io.energy = combined_energy(terms);
    }

private:
    GatheredRanges gathered_;
};

struct Combine : EnergySum<Combine> {
    struct Params : RangeParams {
        std::vector<float> weights;
    };
    struct Ports {
        List<FloatGrid> terms;
        Ref<FloatGrid> energy;
    };

    static void check(const Params& params, NodeCheck& check) {
        const auto terms = check.connections("terms");
        if (!params.weights.empty() && params.weights.size() != terms)
            check.fault("weights", fmt::format("states {} weights for {} terms; state one per term",
                                               params.weights.size(), terms));
        params.range.check(terms, check);
    }

    static std::vector<EnergyTerm> terms(const Params& params, const Ports& io, Context&) {
        std::vector<EnergyTerm> out;
        for (std::size_t n = 0; n < io.terms.size(); ++n)
            out.push_back({io.terms[n], params.weights.empty() ? 1.0f : params.weights.at(n), {}});
        return out;
    }
};

}  // namespace

NodeType energy_combine() {
    return Declare<Combine>(
               "energy.combine",
               "Adds energies, each remapped to [0, 1] over the whole sequence and weighted.")
        .input("terms", &Combine::Ports::terms, "Energies, all on grids with the same transform.")
        .param("weights", &Combine::Params::weights, Unit::none, at_least(0),
               "One weight per term. Empty: all are 1.")
        .param("range", &RangeParams::range, range_doc("that is remapped to [0, 1]"))
        .output("energy", &Combine::Ports::energy,
                "From 0 to the sum of the weights, on the voxels that are active in any term.")
        .digests({"terms", "range"})
        .in_place();
}

namespace {

struct GainParams {
    float gain = 1.0f;
};

/// An energy that looks at the neighbours of each voxel.
template <FloatGrid::Ptr (*energy_of)(const FloatGrid& field, float gain)>
struct StencilEnergy {
    using Params = GainParams;
    struct Ports {
        Ref<FloatGrid> field, energy;
    };
    static void run(const Params& params, Ports& io, Context& context) {
        require_stencil_fits(*io.field, sizeof(float), context.limits().memory);
        io.energy = energy_of(*io.field, params.gain);
    }
};

using Curvature = StencilEnergy<curvature_energy>;
using Gradient = StencilEnergy<gradient_energy>;

}  // namespace

NodeType energy_curvature() {
    return Declare<Curvature>(
               "energy.curvature",
               "High where a surface curves, so that seams avoid its waves, drops and edges.")
        .input("surface", &Curvature::Ports::field,
               "A level set, or any field: its level surfaces count.")
        .param("gain", &Curvature::Params::gain, Unit::none, at_least(0), gain_doc)
        .output("energy", &Curvature::Ports::energy,
                "|sum of the principal curvatures| (field.curvature), 1 per world unit, on the "
                "active voxels of `surface`.")
        .kept()
        .in_place();
}

NodeType energy_gradient() {
    return Declare<Gradient>(
               "energy.gradient",
               "High where a field changes, so that seams avoid its edges and details.")
        .input("field", &Gradient::Ports::field, "Density, temperature or any other field.")
        .param("gain", &Gradient::Params::gain, Unit::none, at_least(0), gain_doc)
        .output("energy", &Gradient::Ports::energy,
                "|grad field|, units of `field` per world unit, on its active voxels.")
        .kept()
        .in_place();
}

namespace {

struct VelocityPorts {
    Ref<VectorGrid> velocity;
    Ref<FloatGrid> energy;
};

struct Kinetic {
    using Params = GainParams;
    using Ports = VelocityPorts;
    static void run(const Params& params, Ports& io, Context& context) {
        require_collocation_fits(*io.velocity, context.limits().memory);
        io.energy = kinetic_energy(io.velocity, params.gain);
    }
};

}  // namespace

NodeType energy_kinetic() {
    return Declare<Kinetic>("energy.kinetic",
                            "High where the flow is fast, so that seams avoid jets and bursts.")
        .input("velocity", &Kinetic::Ports::velocity, velocity_doc)
        .param("gain", &Kinetic::Params::gain, Unit::none, at_least(0), gain_doc)
        .output("energy", &Kinetic::Ports::energy,
                "velocity . velocity, without the factor 1/2, in squared units of `velocity`, on "
                "its active voxels.");
}

namespace {

struct EnergyRemap {
    struct Params : RemapCurve {
        Auto<Interval> range;
    };
    struct Ports {
        Ref<FloatGrid> energy, remapped;
    };

    Interval gathered = empty_range;

    static NodeTraits traits(const Params& params) { return {.gathers = !params.range}; }

    static void check(const Params& params, NodeCheck& check) {
        if (!params.clamp && params.gamma != 1)
            check.fault("gamma",
                        "'gamma' needs clamped values: leave 'gamma' at 1, or 'clamp' at true");
    }

    static std::shared_ptr<FrameRanges> digest(const Params&, const Ports& io, Context&) {
        return std::make_shared<FrameRanges>(FrameRanges{{active_range(*io.energy)}});
    }

    void add(const Params&, const Ref<FrameRanges>& frame, Context&) {
        gathered = joined(gathered, frame->each.at(0));
    }

    void finish(const Params&, Ports&, Context&) {}

    void run(const Params& params, Ports& io, Context&) const {
        io.remapped = remapped_energy(*io.energy, params.range.value_or(gathered), params);
    }
};

}  // namespace

NodeType energy_remap() {
    return Declare<EnergyRemap>("energy.remap",
                                "Remaps an energy's values to another interval: linearly or with a "
                                "gamma, and inverted if wanted.")
        .input("energy", &EnergyRemap::Ports::energy, "An energy, density or any other field.")
        .param("range", &EnergyRemap::Params::range, Unit::none, any_number(),
               "The interval that becomes `to`, in the unit of `energy`. Auto: from the smallest "
               "to the largest active value of the sequence, found in an extra pass. If both are "
               "equal, every value counts as the low end.")
        .param("to", &RemapCurve::to, Unit::none, any_number(),
               "The interval that `range` is mapped to.")
        .param(
            "gamma", &RemapCurve::gamma, Unit::none, between(0.01, 100),
            "Exponent of the curve: below 1 raises low values, above 1 lowers them. Needs `clamp`.")
        .param("clamp", &RemapCurve::clamp,
               "Whether values outside of `range` go to the ends of `to`. False: they are "
               "extrapolated linearly.")
        .param("invert", &RemapCurve::invert,
               "Maps the low end of `range` to the high end of `to`: empty space then gets the "
               "highest energy.")
        .output("energy", &EnergyRemap::Ports::remapped,
                "The remapped values, on the active voxels of `energy`. Its background is remapped "
                "too.")
        .digests({"energy"})
        .in_place();
}

namespace {

struct SurfaceEnergy : EnergySum<SurfaceEnergy> {
    struct Params : SurfaceWeights, RangeParams {};
    struct Ports {
        Ref<FloatGrid> surface;
        Optional<VectorGrid> velocity;
        Ref<FloatGrid> energy;
    };

    static void check(const Params& params, NodeCheck& check) {
        const auto velocities = check.connections("velocity");
        if (velocities == 0 && check.stated("kinetic"))
            check.fault("kinetic",
                        "'kinetic' is the weight of a term that needs 'velocity': connect "
                        "'velocity', or leave 'kinetic' out");
        params.range.check(1 + velocities, check);
    }

    static std::vector<EnergyTerm> terms(const Params& params, const Ports& io, Context& context) {
        require_stencil_fits(*io.surface, sizeof(float), context.limits().memory);
        if (io.velocity) require_collocation_fits(*io.velocity, context.limits().memory);
        return surface_terms(*io.surface, io.velocity, params);
    }
};

}  // namespace

NodeType energy_surface() {
    return Declare<SurfaceEnergy>("energy.surface",
                                  "The paper's energy for liquids and meshes: high where the "
                                  "surface curves, or the flow is fast.")
        .input("surface", &SurfaceEnergy::Ports::surface,
               "The surface as a level set, for example from sdf.from_points.")
        .input("velocity", &SurfaceEnergy::Ports::velocity,
               "Velocity, world units per second, on a grid with the surface's transform; "
               "staggered grids are collocated.")
        .param("curvature", &SurfaceWeights::curvature, Unit::none, at_least(0),
               "Weight of |sum of the principal curvatures|.")
        .param("kinetic", &SurfaceWeights::kinetic, Unit::none, at_least(0),
               "Weight of velocity . velocity; lambda in the paper.")
        .param("range", &RangeParams::range,
               range_doc(before_weighting, ": curvature, then kinetic energy"))
        .output("energy", &SurfaceEnergy::Ports::energy,
                "From 0 to the sum of the terms' weights, on the voxels that are active in either "
                "input.")
        .digests({"surface", "velocity", "range"})
        .kept();
}

namespace {

struct VolumeEnergy : EnergySum<VolumeEnergy> {
    struct Params : VolumeWeights, RangeParams {};
    struct Ports {
        Optional<VectorGrid> velocity;
        OptionalList<FloatGrid> fields;
        Ref<FloatGrid> energy;
    };

    static void check(const Params& params, NodeCheck& check) {
        const auto velocities = check.connections("velocity"), fields = check.connections("fields");
        if (velocities + fields == 0)
            return check.fault("type", "needs 'velocity', 'fields' or both");
        const auto needs = [&](const char* weight, std::size_t connections, const char* input) {
            if (connections == 0 && check.stated(weight))
                check.fault(weight, fmt::format("'{0}' is the weight of a term that needs '{1}': "
                                                "connect '{1}', or leave '{0}' out",
                                                weight, input));
        };
        needs("vorticity", velocities, "velocity");
        needs("kinetic", velocities, "velocity");
        needs("gradient", fields, "fields");
        params.range.check(2 * velocities + fields, check);
    }

    static std::vector<EnergyTerm> terms(const Params& params, const Ports& io, Context& context) {
        if (io.velocity)
            require_stencil_fits(*io.velocity, sizeof(openvdb::Vec3s), context.limits().memory);
        for (const auto& field : io.fields)
            require_stencil_fits(*field, sizeof(float), context.limits().memory);
        return volume_terms(io.velocity, io.fields, params);
    }
};

}  // namespace

NodeType energy_volume() {
    return Declare<VolumeEnergy>("energy.volume",
                                 "The paper's energy for smoke and fire: high where the flow "
                                 "spins, is fast, or its fields change.")
        .input("velocity", &VolumeEnergy::Ports::velocity, velocity_doc)
        .input("fields", &VolumeEnergy::Ports::fields,
               "The visible fields: density, temperature, flame; on grids with the velocity's "
               "transform.")
        .param("vorticity", &VolumeWeights::vorticity, Unit::none, at_least(0),
               "Weight of |curl velocity|.")
        .param("kinetic", &VolumeWeights::kinetic, Unit::none, at_least(0),
               "Weight of velocity . velocity; lambda 1 in the paper.")
        .param("gradient", &VolumeWeights::gradient, Unit::none, at_least(0),
               "Weight of |grad field|, for each field; lambda 2 in the paper.")
        .param("range", &RangeParams::range,
               range_doc(before_weighting,
                         ": vorticity, kinetic energy, then the gradient of each field"))
        .output(
            "energy", &VolumeEnergy::Ports::energy,
            "From 0 to the sum of the terms' weights, on the voxels that are active in any input.")
        .digests({"velocity", "fields", "range"})
        .kept();
}

namespace {

struct Vorticity {
    using Params = GainParams;
    using Ports = VelocityPorts;
    static void run(const Params& params, Ports& io, Context& context) {
        require_stencil_fits(*io.velocity, sizeof(openvdb::Vec3s), context.limits().memory);
        io.energy = vorticity_energy(io.velocity, params.gain);
    }
};

}  // namespace

NodeType energy_vorticity() {
    return Declare<Vorticity>("energy.vorticity",
                              "High where the flow spins, so that seams avoid vortices.")
        .input("velocity", &Vorticity::Ports::velocity, velocity_doc)
        .param("gain", &Vorticity::Params::gain, Unit::none, at_least(0), gain_doc)
        .output("energy", &Vorticity::Ports::energy,
                "|curl velocity|, 1/s, on the active voxels of `velocity`.")
        .kept();
}

}  // namespace fluidcarve
