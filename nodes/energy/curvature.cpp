#include "nodes/energy/curvature.h"

#include "nodes/field/curvature.h"
#include "nodes/field/stencil.h"

#include <cmath>

namespace fluidcarve {
namespace {

struct Curvature {
    struct Params {
        float gain = 1.0f;
    };
    struct Ports {
        Ref<FloatGrid> surface;
        Ref<FloatGrid> energy;
    };
    static void run(const Params& params, Ports& io, Context& context) {
        require_stencil_fits(*io.surface, sizeof(float), context.memory_budget());
        io.energy = curvature_energy(*io.surface, params.gain);
    }
};

}  // namespace

FloatGrid::Ptr curvature_energy(const FloatGrid& surface, float gain) {
    const auto out = map_values<FloatGrid>(*curvature_field(surface), 0.0f, [gain](float curvature) { return gain * std::abs(curvature); });
    out->setName("curvature of " + surface.getName());
    return out;
}

NodeType energy_curvature() {
    return Declare<Curvature>("energy.curvature", "High where a surface curves, so that seams avoid its waves, drops and edges.")
        .input("surface", &Curvature::Ports::surface, "A level set, or any field: its level surfaces count.")
        .param("gain", &Curvature::Params::gain, Unit::none, at_least(0), "Multiplier on the result.")
        .output("energy", &Curvature::Ports::energy,
                "|sum of the principal curvatures| (field.curvature), 1 per world unit, on the active voxels of `surface`.")
        .kept()
        .in_place();
}

}  // namespace fluidcarve
