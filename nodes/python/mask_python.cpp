#include "nodes/python/python_nodes.h"

#include "nodes/python/grid_script.h"

namespace fluidcarve {
namespace {

struct MaskPython : GridScriptNode {
    struct Ports : GridScriptNode::Ports {
        Ref<MaskGrid> mask;
    };

    static void check(const Params& params, NodeCheck& check) {
        GridScript::check(params, "mask", check);
    }
    void run(const Params& params, Ports& io, Context& context) const {
        io.mask = script.states(params, "mask", io.inputs, context);
    }
};

}  // namespace

NodeType mask_python() {
    Declare<MaskPython> node("mask.python",
                             "A mask computed by your own function in Python, `mask(d, ..., at)`.");
    declare_grid_script(node)
        .output("mask", &MaskPython::Ports::mask, "The voxels for which the function returns true.")
        .kept()
        .in_place();
    return node;
}

}  // namespace fluidcarve
