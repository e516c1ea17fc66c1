#include "nodes/energy/vorticity.h"

#include "nodes/field/collocate.h"
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
    static void run(const Params& params, Ports& io, Context&) { io.energy = vorticity_energy(io.velocity, params.gain); }
};

}  // namespace

FloatGrid::Ptr vorticity_energy(const Ref<VectorGrid>& velocity, float gain) {
    const auto scale = static_cast<float>(gain / (2 * cubic_voxel_size(*velocity)));
    // Not tools::curl: that takes a staggered grid for a collocated one, and the corner of an active tile for all of it.
    const auto out = map_stencil<FloatGrid>(*collocated(velocity), 0.0f, [scale](auto& v, const openvdb::Coord& at) {
        const openvdb::Vec3s dx = v.getValue(at.offsetBy(1, 0, 0)) - v.getValue(at.offsetBy(-1, 0, 0));
        const openvdb::Vec3s dy = v.getValue(at.offsetBy(0, 1, 0)) - v.getValue(at.offsetBy(0, -1, 0));
        const openvdb::Vec3s dz = v.getValue(at.offsetBy(0, 0, 1)) - v.getValue(at.offsetBy(0, 0, -1));
        return scale * openvdb::Vec3s(dy[2] - dz[1], dz[0] - dx[2], dx[1] - dy[0]).length();
    });
    out->setName("vorticity of " + velocity->getName());
    return out;
}

NodeType energy_vorticity() {
    return Declare<Vorticity>("energy.vorticity", "High where the flow spins, so that seams avoid vortices.")
        .input("velocity", &Vorticity::Ports::velocity, "Velocity, world units per second; staggered grids are collocated.")
        .param("gain", &Vorticity::Params::gain, Unit::none, at_least(0), "Multiplier on the result.")
        .output("energy", &Vorticity::Ports::energy, "|curl velocity|, 1/s, on the active voxels of `velocity`.");
}

}  // namespace fluidcarve
