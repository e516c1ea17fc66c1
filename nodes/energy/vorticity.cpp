#include "nodes/energy/vorticity.h"

#include "nodes/field/collocate.h"
#include "nodes/field/differences.h"
#include "nodes/field/stencil.h"

namespace fluidcarve {
namespace {

struct Vorticity {
    struct Params {
        float gain = 1.0f;
    };
    struct Ports {
        Ref<VectorGrid> velocity;
        Ref<FloatGrid> energy;
    };
    static void run(const Params& params, Ports& io, Context& context) {
        require_stencil_fits(*io.velocity, sizeof(openvdb::Vec3s), context.memory_budget());
        io.energy = vorticity_energy(io.velocity, params.gain);
    }
};

}  // namespace

FloatGrid::Ptr vorticity_energy(const Ref<VectorGrid>& velocity, float gain) {
    const auto out = map_stencil<FloatGrid>(*collocated(velocity), 0.0f, [gain, jacobian = Jacobian(*velocity)](auto& v, const openvdb::Coord& at) {
        return static_cast<float>(gain * openvdb::Vec3d(curl_at(v, at, jacobian)).length());
    });
    out->setName("vorticity of " + velocity->getName());
    return out;
}

NodeType energy_vorticity() {
    return Declare<Vorticity>("energy.vorticity", "High where the flow spins, so that seams avoid vortices.")
        .input("velocity", &Vorticity::Ports::velocity, "Velocity, world units per second; staggered grids are collocated.")
        .param("gain", &Vorticity::Params::gain, Unit::none, at_least(0), "Multiplier on the result.")
        .output("energy", &Vorticity::Ports::energy, "|curl velocity|, 1/s, on the active voxels of `velocity`.")
        .kept();
}

}  // namespace fluidcarve
