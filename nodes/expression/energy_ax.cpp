#include "nodes/expression/energy_ax.h"

#include "nodes/expression/ax_node.h"

namespace fluidcarve {
namespace {

constexpr auto output = "energy";

struct EnergyAx {
    using Params = AxParams;
    struct Ports {
        Named<AnyGrid> inputs;
        Ref<FloatGrid> energy;
    };

    AxProgram program;

    static void check(const Params& params, NodeCheck& check) { check_ax(params, output, check); }

    void run(const Params& params, Ports& io, Context& context) const { io.energy = program.run(params, output, 0, io.inputs, context); }
};

}  // namespace

NodeType energy_ax() {
    return Declare<EnergyAx>("energy.ax", "An energy by a program of your own, in OpenVDB AX: what you say is left alone, whatever the built-in energies know.")
        .input("inputs", &EnergyAx::Ports::inputs, ax_inputs_doc)
        .param("params", &AxParams::params, ax_params_doc)
        .required("code", &AxParams::code, ax_code_doc("@energy"))
        .output("energy", &EnergyAx::Ports::energy, "What the program writes, at least 0 and finite, on the voxels that are active in any input; elsewhere 0.")
        .kept();
}

}  // namespace fluidcarve
