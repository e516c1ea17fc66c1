#include "nodes/energy/volume.h"

#include "nodes/energy/gradient.h"
#include "nodes/energy/kinetic.h"
#include "nodes/energy/term_ranges.h"
#include "nodes/energy/vorticity.h"
#include "nodes/field/collocate.h"
#include "nodes/field/stencil.h"

namespace fluidcarve {
namespace {

struct VolumeEnergy {
    struct Params : VolumeWeights {
        TermRanges range;
    };
    struct Ports {
        Optional<VectorGrid> velocity;
        OptionalList<FloatGrid> fields;
        Ref<FloatGrid> energy;
    };

    GatheredRanges gathered;

    static bool gathers(const Params& params) { return params.range.gathers(); }

    static void check(const Params& params, NodeCheck& check) {
        const auto velocities = check.connections("velocity"), fields = check.connections("fields");
        if (velocities + fields == 0) return check.fault("type", "needs 'velocity', 'fields' or both");
        const auto needs = [&](const char* weight, std::size_t connections, const char* input) {
            if (connections == 0 && check.stated(weight))
                check.fault(weight, fmt::format("'{0}' is the weight of a term that needs '{1}': connect '{1}', or leave '{0}' out", weight, input));
        };
        needs("vorticity", velocities, "velocity");
        needs("kinetic", velocities, "velocity");
        needs("gradient", fields, "fields");
        params.range.check(2 * velocities + fields, check);
    }

    static void require_terms_fit(const Ports& io, const Context& context) {
        if (io.velocity) require_stencil_fits(*io.velocity, sizeof(openvdb::Vec3s), context.memory_budget());
        for (const auto& field : io.fields) require_stencil_fits(*field, sizeof(float), context.memory_budget());
    }

    static std::shared_ptr<FrameRanges> digest(const Params& params, const Ports& io, Context& context) {
        require_terms_fit(io, context);
        std::vector<Ref<FloatGrid>> energies;
        for (const auto& term : volume_terms(io.velocity, io.fields, params)) energies.push_back(term.energy);
        return ranges_of(params.range, energies);
    }

    void add(const Params&, const Ref<FrameRanges>& frame, Context&) { gathered.add(*frame); }

    void finish(const Params&, Ports&, Context&) {}

    void run(const Params& params, Ports& io, Context& context) const {
        require_terms_fit(io, context);
        auto terms = volume_terms(io.velocity, io.fields, params);
        for (std::size_t n = 0; n < terms.size(); ++n) terms[n].range = gathered.of(params.range, n);
        io.energy = combined_energy(terms);
    }
};

}  // namespace

std::vector<EnergyTerm> volume_terms(const Ref<VectorGrid>& velocity, const std::vector<Ref<FloatGrid>>& fields, const VolumeWeights& weights) {
    std::vector<EnergyTerm> out;
    if (velocity) {
        const auto centred = collocated(velocity);
        out.push_back({vorticity_energy(centred, 1), weights.vorticity, {}});
        out.push_back({kinetic_energy(centred, 1), weights.kinetic, {}});
    }
    for (const auto& field : fields) out.push_back({gradient_energy(*field, 1), weights.gradient, {}});
    return out;
}

NodeType energy_volume() {
    return Declare<VolumeEnergy>("energy.volume", "The paper's energy for smoke and fire: high where the flow spins, is fast, or its fields change.")
        .input("velocity", &VolumeEnergy::Ports::velocity, "Velocity, world units per second; staggered grids are collocated.")
        .input("fields", &VolumeEnergy::Ports::fields, "The visible fields: density, temperature, flame; on grids with the velocity's transform.")
        .param("vorticity", &VolumeWeights::vorticity, Unit::none, at_least(0), "Weight of |curl velocity|.")
        .param("kinetic", &VolumeWeights::kinetic, Unit::none, at_least(0), "Weight of velocity . velocity; lambda 1 in the paper.")
        .param("gradient", &VolumeWeights::gradient, Unit::none, at_least(0), "Weight of |grad field|, for each field; lambda 2 in the paper.")
        .param(
            "range", &VolumeEnergy::Params::range,
            "The interval of each term that is remapped to [0, 1] before weighting; values outside are clamped. Auto: from the smallest to the largest active "
            "value of the sequence, found in an extra pass. A list states one interval or auto per term: vorticity, kinetic energy, then the gradient of each "
            "field. A constant term counts as 0.")
        .output("energy", &VolumeEnergy::Ports::energy, "From 0 to the sum of the terms' weights, on the voxels that are active in any input.")
        .digests({"velocity", "fields", "range"})
        .kept();
}

}  // namespace fluidcarve
