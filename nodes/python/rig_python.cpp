#include "nodes/python/python_nodes.h"

#include "carve/rig/rig.h"
#include "carve/volume/volume.h"
#include "graph/types/context.h"
#include "graph/types/node_check.h"
#include "nodes/params/check_params.h"
#include "nodes/python/grid_script.h"
#include "nodes/python/shared_grids.h"

#include <fmt/format.h>

#include <optional>

namespace fluidcarve {
namespace {

using Json = nlohmann::json;

struct RigPython {
    struct Params : PythonParams {
        bool animate = false;
        bool closed = false;
        Vec3 up{0, 0, 1};
    };
    struct Ports {
        OptionalNamed<AnyGrid> inputs;
        Ref<Rig> rig;
    };

    static NodeTraits traits(const Params& params) {
        auto out = script_traits(params);
        out.animates = params.animate;
        return out;
    }
    static void check(const Params& params, NodeCheck& check) {
        check_direction("up", params.up, check);
        check_script(params, "rig", check.names("inputs"), check);
    }

    static void run(const Params& params, Ports& io, Context& context) {
        Rig rig{{}, params.closed, openvdb::Vec3d(params.up.data()), {}};
        call_script(
            params, "rig", context,
            [&](Worker& worker) {
                Json out{{"wants", "positions"}};
                if (!io.inputs.empty()) {
                    const SharedGrids grids(io.inputs, context.limits().memory);
                    out["grids"] = grids.write(worker, grids.parts(std::nullopt).front());
                }
                return out;
            },
            [&](Worker& worker, const Json& answer) {
                const auto count = answer.at("count").get<std::size_t>();
                const auto* const at = reinterpret_cast<const double*>(
                    worker.answered.seen(count * 3 * sizeof(double)));
                for (std::size_t n = 0; n < count; ++n)
                    rig.points.emplace_back(at[3 * n], at[3 * n + 1], at[3 * n + 2]);
            });
        if (const auto fault = rig_fault(rig); !fault.empty())
            throw Failure(fmt::format("{}: rig returned no path: {}", params.script.at(0), fault));
        io.rig = std::make_shared<Rig>(std::move(rig));
    }
};

}  // namespace

NodeType rig_python() {
    Declare<RigPython> node("rig.python",
                            "A rig through points that your own function in Python returns, "
                            "`rig(..., at)`: an array (n, 3) in the world, in order.");
    node.input("inputs", &RigPython::Ports::inputs, python_inputs_doc);
    return declare_python(node)
        .param("animate", &RigPython::Params::animate,
               "Whether there is a rig for each frame, though no input changes: the function then "
               "looks at `at.frame`.")
        .param("closed", &RigPython::Params::closed,
               "Whether the rig returns from its last point to its first.")
        .param("up", &RigPython::Params::up, Unit::none, any_number(),
               "Direction of the lattice's `v` at the first point; made orthogonal to the path.")
        .output("rig", &RigPython::Ports::rig, "The rig.");
}

}  // namespace fluidcarve
