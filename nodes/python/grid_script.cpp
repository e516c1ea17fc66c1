#include "nodes/python/grid_script.h"

#include "graph/types/context.h"
#include "graph/types/node_check.h"
#include "nodes/field/lowest_wrong.h"
#include "nodes/python/shared_grids.h"

#include <fmt/format.h>

#include <cmath>

namespace fluidcarve {

const char* const python_inputs_doc =
    "Grids by name, all with the same transform: `{d: sim.density, vel: sim.velocity}`. The function gets each as an argument of that name: its `dense()`, "
    "`values` or `leaves` are arrays of numpy. Staggered vectors are collocated first.";

void check_grid_script(const PythonParams& params, const std::string& function, NodeCheck& check) {
    if (check.stated("inputs") && check.connections("inputs") == 0) return check.fault("inputs", "'inputs' names no grid; name at least one");
    check_script(params, function, check.names("inputs"), check);
}

FloatGrid::Ptr numbers_of_script(const PythonParams& params, const std::string& function, float least,
                                 const std::vector<std::pair<std::string, Ref<AnyGrid>>>& inputs, Context& context) {
    const SharedGrids grids(inputs, context.memory_budget());
    FloatGrid::Ptr out;
    call_script(
        params, function, context,
        [&](Worker& worker) {
            return nlohmann::json{{"grids", grids.write(worker)}, {"wants", "numbers"}};
        },
        [&](Worker& worker, const nlohmann::json&) { out = grids.numbers(worker); });
    out->setName(function);
    if (const auto wrong = lowest_wrong(*out, least))
        throw Failure(fmt::format("{}: {} returned {} at voxel [{}, {}, {}]; {}", params.script.at(0), function, wrong->value, wrong->at.x(), wrong->at.y(),
                                  wrong->at.z(),
                                  std::isfinite(wrong->value) ? fmt::format("it must be at least {0}: use numpy.maximum(..., {0}) or abs(...)", least)
                                                              : "guard divisions, roots and logarithms against inputs such as 0 or negative numbers"));
    return out;
}

MaskGrid::Ptr states_of_script(const PythonParams& params, const std::string& function, const std::vector<std::pair<std::string, Ref<AnyGrid>>>& inputs,
                               Context& context) {
    const SharedGrids grids(inputs, context.memory_budget());
    MaskGrid::Ptr out;
    call_script(
        params, function, context,
        [&](Worker& worker) {
            return nlohmann::json{{"grids", grids.write(worker)}, {"wants", "states"}};
        },
        [&](Worker& worker, const nlohmann::json& answer) { out = grids.states(worker, answer.at("leaves").get<std::uint64_t>()); });
    out->setName(function);
    return out;
}

}  // namespace fluidcarve
