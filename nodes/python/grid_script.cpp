#include "nodes/python/grid_script.h"

#include "carve/base/words.h"
#include "carve/field/lowest_wrong.h"
#include "graph/text/base64.h"
#include "graph/types/context.h"
#include "graph/types/node_check.h"
#include "nodes/python/shared_grids.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

namespace fluidcarve {

using Json = nlohmann::json;

const char* const python_inputs_doc =
    "Grids by name, all with the same transform: `{d: sim.density, vel: sim.velocity}`. The "
    "function gets each as an argument of that name: its `dense()`, `values` or `leaves` are "
    "arrays of numpy. Staggered vectors are collocated first.";

void GridScript::check(const PythonParams& params, const std::string& function, NodeCheck& check) {
    if (check.stated("inputs") && check.connections("inputs") == 0)
        return check.fault("inputs", "'inputs' names no grid; name at least one");
    check_script(params, function, check.names("inputs"), check);
}

void GridScript::add(const GridScriptParams& params, const Inputs& inputs, Context& context) {
    const SharedGrids grids(inputs, context.limits().memory);
    // A worker of its own: what the script gathers in its variables is for this node alone.
    if (!worker_) worker_ = new_worker(params, context);
    call_script(
        *worker_, params, "add", context,
        [&](Worker& worker) {
            return Json{{"grids", grids.write(worker, grids.parts(std::nullopt).front())},
                        {"wants", "nothing"}};
        },
        [](Worker&, const Json&) {});
}

void GridScript::finish(const GridScriptParams& params, Context& context) {
    call_script(
        *worker_, params, "finish", context,
        [](Worker&) {
            return Json{{"wants", "found"}};
        },
        [&](Worker& worker, const Json& answer) {
            const auto bytes = answer.at("bytes").get<std::size_t>();
            found_ = base64({reinterpret_cast<const char*>(worker.answered.seen(bytes)), bytes});
        });
    worker_.reset();
}

FloatGrid::Ptr GridScript::numbers(const GridScriptParams& params, const std::string& function,
                                   float least, const Inputs& inputs, Context& context) const {
    const SharedGrids grids(inputs, context.limits().memory);
    SharedGrids::Numbers out(grids, least);
    for (const auto& part : grids.parts(params.halo))
        call_script(
            params, function, context,
            [&](Worker& worker) {
                return with_found(worker, found_,
                                  {{"grids", grids.write(worker, part)}, {"wants", "numbers"}});
            },
            [&](Worker& worker, const Json&) { out.take(worker, part); });
    out.grid->setName(function);
    if (out.good) return out.grid;
    if (const auto wrong = lowest_wrong(*out.grid, least))
        throw Failure(fmt::format(
            "{}: {} returned {} at voxel [{}]; {}", params.script.at(0), function, wrong->value,
            numbers_text(wrong->at),
            std::isfinite(wrong->value)
                ? fmt::format("it must be at least {0}: use numpy.maximum(..., {0}) or abs(...)",
                              least)
                : "guard divisions, roots and logarithms against inputs such as 0 or negative "
                  "numbers"));
    return out.grid;
}

MaskGrid::Ptr GridScript::states(const GridScriptParams& params, const std::string& function,
                                 const Inputs& inputs, Context& context) const {
    const SharedGrids grids(inputs, context.limits().memory);
    const auto out = MaskGrid::create();
    for (const auto& part : grids.parts(params.halo))
        call_script(
            params, function, context,
            [&](Worker& worker) {
                return with_found(worker, found_,
                                  {{"grids", grids.write(worker, part)}, {"wants", "states"}});
            },
            [&](Worker& worker, const Json& answer) {
                grids.add_states(*out, worker, answer.at("leaves").get<std::uint64_t>(), part);
            });
    out->setTransform(grids.transform().copy());
    out->setName(function);
    return out;
}

}  // namespace fluidcarve
