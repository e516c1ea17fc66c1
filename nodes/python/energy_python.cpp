#include "nodes/python/python_nodes.h"

#include "nodes/python/grid_script.h"

#include <openvdb/tools/ChangeBackground.h>

namespace fluidcarve {
namespace {

struct EnergyPython : GridScriptNode {
    struct Params : GridScriptParams {
        float outside = 0;
    };
    struct Ports : GridScriptNode::Ports {
        Ref<FloatGrid> energy;
    };

    static void check(const Params& params, NodeCheck& check) {
        GridScript::check(params, "energy", check);
    }
    void run(const Params& params, Ports& io, Context& context) const {
        const auto energy = script.numbers(params, "energy", 0, io.inputs, context);
        // Inactive voxels are all 0 so far, the background.
        if (params.outside > 0) openvdb::tools::changeBackground(energy->tree(), params.outside);
        io.energy = energy;
    }
};

}  // namespace

NodeType energy_python() {
    Declare<EnergyPython> node("energy.python",
                               "An energy computed by your own function in Python, `energy(d, ..., "
                               "at)`, with numpy or what else you have.");
    declare_grid_script(node)
        .param("outside", &EnergyPython::Params::outside, Unit::none, at_least(0),
               "The energy where no input is active. 0: seams cost nothing in empty space, and go "
               "there first.")
        .output("energy", &EnergyPython::Ports::energy,
                "What the function returns, finite and at least 0, on the voxels that are active "
                "in any input; `outside` elsewhere.")
        .kept()
        .in_place();
    return node;
}

}  // namespace fluidcarve
