#include "nodes/python/python_nodes.h"

#include "nodes/python/grid_script.h"

#include <limits>

namespace fluidcarve {
namespace {

struct FieldPython : GridScriptNode {
    struct Ports : GridScriptNode::Ports {
        Ref<FloatGrid> out;
    };

    static void check(const Params& params, NodeCheck& check) {
        GridScript::check(params, "field", check);
    }
    void run(const Params& params, Ports& io, Context& context) const {
        io.out = script.numbers(params, "field", -std::numeric_limits<float>::infinity(), io.inputs,
                                context);
    }
};

}  // namespace

NodeType field_python() {
    Declare<FieldPython> node(
        "field.python", "A field computed by your own function in Python, `field(d, ..., at)`.");
    declare_grid_script(node)
        .output("out", &FieldPython::Ports::out,
                "What the function returns, finite, on the voxels that are active in any input; 0 "
                "elsewhere.")
        .kept()
        .in_place();
    return node;
}

}  // namespace fluidcarve
