#include "nodes/python/nodes.h"

#include "nodes/python/grid_script.h"

namespace fluidcarve {
namespace {

struct MaskPython {
    using Params = GridScriptParams;
    struct Ports {
        Named<AnyGrid> inputs;
        Ref<MaskGrid> mask;
    };

    GridScript script;

    static void check(const Params& params, NodeCheck& check) {
        GridScript::check(params, "mask", check);
    }
    static Further depends(const Params& params) { return script_depends(params); }
    static bool gathers(const Params& params) { return script_gathers(params); }
    void add(const Params& params, const Ports& io, Context& context) {
        script.add(params, io.inputs, context);
    }
    void finish(const Params& params, Ports&, Context& context) { script.finish(params, context); }
    void run(const Params& params, Ports& io, Context& context) const {
        io.mask = script.states(params, "mask", io.inputs, context);
    }
};

}  // namespace

NodeType mask_python() {
    Declare<MaskPython> node("mask.python",
                             "A mask computed by your own function in Python, `mask(d, ..., at)`.");
    node.input("inputs", &MaskPython::Ports::inputs, python_inputs_doc);
    declare_grid_script(node)
        .output("mask", &MaskPython::Ports::mask, "The voxels for which the function returns true.")
        .kept()
        .in_place();
    return node;
}

}  // namespace fluidcarve
