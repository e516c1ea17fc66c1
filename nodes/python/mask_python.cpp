#include "nodes/python/mask_python.h"

#include "nodes/python/grid_script.h"

namespace fluidcarve {
namespace {

struct MaskPython {
    using Params = PythonParams;
    struct Ports {
        Named<AnyGrid> inputs;
        Ref<MaskGrid> mask;
    };

    static void check(const Params& params, NodeCheck& check) { check_grid_script(params, "mask", check); }
    static Further depends(const Params& params) { return script_depends(params); }
    static void run(const Params& params, Ports& io, Context& context) { io.mask = states_of_script(params, "mask", io.inputs, context); }
};

}  // namespace

NodeType mask_python() {
    Declare<MaskPython> node("mask.python", "A mask computed by your own function in Python, `mask(d, ..., at)`.");
    node.input("inputs", &MaskPython::Ports::inputs, python_inputs_doc);
    declare_python(node).output("mask", &MaskPython::Ports::mask, "The voxels for which the function returns true.").kept().in_place();
    return node;
}

}  // namespace fluidcarve
