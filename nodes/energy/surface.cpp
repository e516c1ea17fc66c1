#include "nodes/energy/surface.h"

#include "nodes/energy/curvature.h"
#include "nodes/energy/kinetic.h"
#include "nodes/energy/term_ranges.h"
#include "nodes/field/collocate.h"
#include "nodes/field/stencil.h"

namespace fluidcarve {
namespace {

struct SurfaceEnergy {
    struct Params : SurfaceWeights {
        TermRanges range;
    };
    struct Ports {
        Ref<FloatGrid> surface;
        Optional<VectorGrid> velocity;
        Ref<FloatGrid> energy;
    };

    GatheredRanges gathered;

    static bool gathers(const Params& params) { return params.range.gathers(); }

    static void check(const Params& params, NodeCheck& check) {
        const auto velocities = check.connections("velocity");
        if (velocities == 0 && check.stated("kinetic"))
            check.fault("kinetic", "'kinetic' is the weight of a term that needs 'velocity': connect 'velocity', or leave 'kinetic' out");
        params.range.check(1 + velocities, check);
    }

    static void require_terms_fit(const Ports& io, const Context& context) {
        require_stencil_fits(*io.surface, sizeof(float), context.memory_budget());
        if (io.velocity) require_collocation_fits(*io.velocity, context.memory_budget());
    }

    static std::shared_ptr<FrameRanges> digest(const Params& params, const Ports& io, Context& context) {
        require_terms_fit(io, context);
        std::vector<Ref<FloatGrid>> energies;
        for (const auto& term : surface_terms(*io.surface, io.velocity, params)) energies.push_back(term.energy);
        return ranges_of(params.range, energies);
    }

    void add(const Params&, const Ref<FrameRanges>& frame, Context&) { gathered.add(*frame); }

    void finish(const Params&, Ports&, Context&) {}

    void run(const Params& params, Ports& io, Context& context) const {
        require_terms_fit(io, context);
        auto terms = surface_terms(*io.surface, io.velocity, params);
        for (std::size_t n = 0; n < terms.size(); ++n) terms[n].range = gathered.of(params.range, n);
        io.energy = combined_energy(terms);
    }
};

}  // namespace

std::vector<EnergyTerm> surface_terms(const FloatGrid& surface, const Ref<VectorGrid>& velocity, const SurfaceWeights& weights) {
    std::vector<EnergyTerm> out{{curvature_energy(surface, 1), weights.curvature, {}}};
    if (velocity) out.push_back({kinetic_energy(velocity, 1), weights.kinetic, {}});
    return out;
}

NodeType energy_surface() {
    return Declare<SurfaceEnergy>("energy.surface", "The paper's energy for liquids and meshes: high where the surface curves, or the flow is fast.")
        .input("surface", &SurfaceEnergy::Ports::surface, "The surface as a level set, for example from sdf.from_points.")
        .input("velocity", &SurfaceEnergy::Ports::velocity,
               "Velocity, world units per second, on a grid with the surface's transform; staggered grids are collocated.")
        .param("curvature", &SurfaceWeights::curvature, Unit::none, at_least(0), "Weight of |sum of the principal curvatures|.")
        .param("kinetic", &SurfaceWeights::kinetic, Unit::none, at_least(0), "Weight of velocity . velocity; lambda in the paper.")
        .param(
            "range", &SurfaceEnergy::Params::range,
            "The interval of each term that is remapped to [0, 1] before weighting; values outside are clamped. Auto: from the smallest to the largest active "
            "value of the sequence, found in an extra pass. A list states one interval or auto per term: curvature, then kinetic energy. A constant term "
            "counts as 0.")
        .output("energy", &SurfaceEnergy::Ports::energy, "From 0 to the sum of the terms' weights, on the voxels that are active in either input.")
        .digests({"surface", "velocity", "range"})
        .kept();
}

}  // namespace fluidcarve
