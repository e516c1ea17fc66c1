#include "nodes/python/nodes.h"

#include "nodes/python/grid_script.h"

#include <openvdb/tools/ChangeBackground.h>

namespace fluidcarve {
namespace {

struct EnergyPython {
    struct Params : GridScriptParams {
        float outside = 0;
    };
    struct Ports {
        Named<AnyGrid> inputs;
        Ref<FloatGrid> energy;
    };

    GridScript script;

    static void check(const Params& params, NodeCheck& check) {
        GridScript::check(params, "energy", check);
    }
    static Further depends(const Params& params) { return script_depends(params); }
    static bool gathers(const Params& params) { return script_gathers(params); }
    void add(const Params& params, const Ports& io, Context& context) {
        script.add(params, io.inputs, context);
    }
    void finish(const Params& params, Ports&, Context& context) { script.finish(params, context); }
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
    node.input("inputs", &EnergyPython::Ports::inputs, python_inputs_doc);
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
