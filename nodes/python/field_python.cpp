#include "nodes/python/nodes.h"

#include "nodes/python/grid_script.h"

#include <limits>

namespace fluidcarve {
namespace {

struct FieldPython {
    using Params = GridScriptParams;
    struct Ports {
        Named<AnyGrid> inputs;
        Ref<FloatGrid> out;
    };

    GridScript script;

    static void check(const Params& params, NodeCheck& check) {
        GridScript::check(params, "field", check);
    }
    static Further depends(const Params& params) { return script_depends(params); }
    static bool gathers(const Params& params) { return script_gathers(params); }
    void add(const Params& params, const Ports& io, Context& context) {
        script.add(params, io.inputs, context);
    }
    void finish(const Params& params, Ports&, Context& context) { script.finish(params, context); }
    void run(const Params& params, Ports& io, Context& context) const {
        io.out = script.numbers(params, "field", -std::numeric_limits<float>::infinity(), io.inputs,
                                context);
    }
};

}  // namespace

NodeType field_python() {
    Declare<FieldPython> node(
        "field.python", "A field computed by your own function in Python, `field(d, ..., at)`.");
    node.input("inputs", &FieldPython::Ports::inputs, python_inputs_doc);
    declare_grid_script(node)
        .output("out", &FieldPython::Ports::out,
                "What the function returns, finite, on the voxels that are active in any input; 0 "
                "elsewhere.")
        .kept()
        .in_place();
    return node;
}

}  // namespace fluidcarve
