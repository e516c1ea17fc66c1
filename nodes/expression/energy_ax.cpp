#include "nodes/expression/energy_ax.h"

#include "nodes/expression/ax_node.h"

namespace fluidcarve {
namespace {

constexpr auto energy_output = "energy";

struct EnergyAx {
    using Params = AxParams;
    struct Ports {
        Named<AnyGrid> inputs;
        Ref<FloatGrid> energy;
    };

    AxProgram program;

    static void check(const Params& params, NodeCheck& check) { check_ax(params, energy_output, check); }

    void run(const Params& params, Ports& io, Context& context) const { io.energy = program.run(params, energy_output, 0, io.inputs, context); }
};

}  // namespace

NodeType energy_ax() {
    return Declare<EnergyAx>("energy.ax", "An energy computed by your own program, in OpenVDB AX, where the built-in energies are not enough.")
        .input("inputs", &EnergyAx::Ports::inputs, ax_inputs_doc)
        .param("params", &AxParams::params, ax_params_doc)
        .required("code", &AxParams::code, ax_code_doc("@energy"))
        .output("energy", &EnergyAx::Ports::energy,
                "The values that the program writes, finite and at least 0, on the voxels that are active in any input; 0 elsewhere.")
        .kept()
        .in_place();
}

}  // namespace fluidcarve
