#include "nodes/energy/kinetic.h"

#include "nodes/field/collocate.h"
#include "nodes/field/stencil.h"

namespace fluidcarve {
namespace {

struct Kinetic {
    struct Params {
        float gain = 1.0f;
    };
    struct Ports {
        Ref<VectorGrid> velocity;
        Ref<FloatGrid> energy;
    };
    static void run(const Params& params, Ports& io, Context& context) {
        require_collocation_fits(*io.velocity, context.memory_budget());
        io.energy = kinetic_energy(io.velocity, params.gain);
    }
};

}  // namespace

FloatGrid::Ptr kinetic_energy(const Ref<VectorGrid>& velocity, float gain) {
    const auto out = map_values<FloatGrid>(*collocated(velocity), 0.0f, [gain](const openvdb::Vec3s& u) { return gain * u.lengthSqr(); });
    out->setName("kinetic energy of " + velocity->getName());
    return out;
}

NodeType energy_kinetic() {
    return Declare<Kinetic>("energy.kinetic", "High where the flow is fast, so that seams avoid jets and bursts.")
        .input("velocity", &Kinetic::Ports::velocity, "Velocity, world units per second; staggered grids are collocated.")
        .param("gain", &Kinetic::Params::gain, Unit::none, at_least(0), "Multiplier on the result.")
        .output("energy", &Kinetic::Ports::energy, "velocity . velocity, without the factor 1/2, in squared units of `velocity`, on its active voxels.");
}

}  // namespace fluidcarve
