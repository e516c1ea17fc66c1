#include "nodes/expression/field_ax.h"

#include "nodes/expression/ax_node.h"

#include <limits>
namespace fluidcarve {
namespace {

constexpr auto field_output = "out";

struct FieldAx {
    using Params = AxParams;
    struct Ports {
        Named<AnyGrid> inputs;
        Ref<FloatGrid> out;
    };

    AxProgram program;

    static void check(const Params& params, NodeCheck& check) {
        check_ax(params, field_output, check);
    }
    static NodeTraits traits(const Params& params) { return {.animates = may_read_moment(params)}; }

    void run(const Params& params, Ports& io, Context& context) const {
        io.out = program.run(params, field_output, -std::numeric_limits<float>::infinity(),
                             io.inputs, context);
    }
};

}  // namespace

NodeType field_ax() {
    return Declare<FieldAx>("field.ax",
                            "A field computed by your own program, in OpenVDB AX: to mix, scale or "
                            "cut fields before other nodes use them.")
        .input("inputs", &FieldAx::Ports::inputs, ax_inputs_doc)
        .param("params", &AxParams::params, ax_params_doc)
        .required("code", &AxParams::code, ax_code_doc("@out"))
        .output("out", &FieldAx::Ports::out,
                "The values that the program writes, finite, on the voxels that are active in any "
                "input; 0 elsewhere.")
        .kept()
        .in_place();
}

}  // namespace fluidcarve
