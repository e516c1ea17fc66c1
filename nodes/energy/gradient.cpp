#include "nodes/energy/gradient.h"

#include "nodes/field/differences.h"
#include "nodes/field/stencil.h"

namespace fluidcarve {
namespace {

struct Gradient {
    struct Params {
        float gain = 1.0f;
    };
    struct Ports {
        Ref<FloatGrid> field;
        Ref<FloatGrid> energy;
    };
    static void run(const Params& params, Ports& io, Context& context) {
        require_stencil_fits(*io.field, sizeof(float), context.memory_budget());
        io.energy = gradient_energy(*io.field, params.gain);
    }
};

}  // namespace

FloatGrid::Ptr gradient_energy(const FloatGrid& field, float gain) {
    const auto out = map_stencil<FloatGrid>(field, 0.0f, [gain, jacobian = Jacobian(field)](auto& s, const openvdb::Coord& at) {
        return static_cast<float>(gain * jacobian.steepness(differences_at(s, at)));
    });
    out->setName("gradient of " + field.getName());
    return out;
}

NodeType energy_gradient() {
    return Declare<Gradient>("energy.gradient", "High where a field changes, so that seams avoid its edges and details.")
        .input("field", &Gradient::Ports::field, "Density, temperature or any other field.")
        .param("gain", &Gradient::Params::gain, Unit::none, at_least(0), "Multiplier on the result.")
        .output("energy", &Gradient::Ports::energy, "|grad field|, units of `field` per world unit, on its active voxels.")
        .kept()
        .in_place();
}

}  // namespace fluidcarve
