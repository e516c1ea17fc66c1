#include "nodes/expression/energy_ax.h"

#include "nodes/expression/ax_node.h"

#include <openvdb/tools/ChangeBackground.h>

namespace fluidcarve {
namespace {

constexpr auto energy_output = "energy";

struct EnergyAx {
    struct Params : AxParams {
        float outside = 0;
    };
    struct Ports {
        Named<AnyGrid> inputs;
        Ref<FloatGrid> energy;
    };

    AxProgram program;

    static void check(const Params& params, NodeCheck& check) {
        check_ax(params, energy_output, check);
    }
    static NodeTraits traits(const Params& params) { return {.animates = may_read_moment(params)}; }

    void run(const Params& params, Ports& io, Context& context) const {
        const auto energy = program.run(params, energy_output, 0, io.inputs, context);
        // Inactive voxels are all 0 so far, the background.
        if (params.outside > 0) openvdb::tools::changeBackground(energy->tree(), params.outside);
        io.energy = energy;
    }
};

}  // namespace

NodeType energy_ax() {
    return Declare<EnergyAx>("energy.ax",
                             "An energy computed by your own program, in OpenVDB AX, where the "
                             "built-in energies are not enough.")
        .input("inputs", &EnergyAx::Ports::inputs, ax_inputs_doc)
        .param("params", &AxParams::params, ax_params_doc)
        .required("code", &AxParams::code, ax_code_doc("@energy"))
        .param("outside", &EnergyAx::Params::outside, Unit::none, at_least(0),
               "The energy where no input is active. 0: seams cost nothing in empty space, and go "
               "there first.")
        .output("energy", &EnergyAx::Ports::energy,
                "The values that the program writes, finite and at least 0, on the voxels that are "
                "active in any input; `outside` elsewhere.")
        .kept()
        .in_place();
}

}  // namespace fluidcarve
