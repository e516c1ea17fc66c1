#include "nodes/python/nodes.h"

#include "carve/field/dense.h"
#include "graph/types/context.h"
#include "graph/types/node_check.h"
#include "nodes/python/python_script.h"
#include "nodes/solving/solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {
namespace {

using Json = nlohmann::json;

/// Writes the cost of each entry in a window: [t, k, lateral, entry].
/// @return the position behind the last cost
template <class Cell>
float* write_costs(const EnergyVolume& energy, Window window, float* to) {
    const auto costs = energy.costs();
    for (std::size_t t = 0; t < energy.frames(); ++t)
        for (std::size_t column = 0; column < energy.columns_per_frame(); ++column) {
            const auto* const entries = energy.cells<Cell>(t) + column * energy.stride();
            to = std::transform(entries + window.first, entries + window.last + 1, to,
                                [&](Cell cell) { return costs(cell); });
        }
    return to;
}

/// Writes the field in a window: [t, k, lateral, entry].
void write_field(const EnergyVolume& energy, Window window, float* to) {
    const auto columns = energy.columns_per_frame() * energy.frames();
    const auto width = static_cast<std::size_t>(window.size());
    for (std::size_t column = 0; column < columns; ++column)
        energy.field(column).read(window.first, {to + column * width, width});
}

std::string place_text(const Columns& columns, std::size_t column) {
    const auto at = columns.place(column);
    return fmt::format("[{}, {}, {}]", at.t, at.k, at.lateral);
}

/// The fault of a seam: an entry beside the window or protected, or neighbours that differ by more
/// than 1. Empty: none.
std::string fault_of_seam(const std::vector<std::uint16_t>& at, const float* costs, Window window,
                          const Columns& columns) {
    const auto width = static_cast<std::size_t>(window.size());
    for (std::size_t n = 0; n < at.size(); ++n) {
        const auto entry = at[n] - window.first;
        if (std::isinf(costs[n * width + static_cast<std::size_t>(entry)]))
            return fmt::format("entry {} at {} is protected: its energy is inf", entry,
                               place_text(columns, n));
        for (const auto beside : columns.around(n, columns.place(n)))
            if (beside != Columns::none && std::abs(at[n] - at[beside]) > 1)
                return fmt::format(
                    "entries {} and {} at the neighbours {} and {} differ by more than 1", entry,
                    at[beside] - window.first, place_text(columns, n), place_text(columns, beside));
    }
    return {};
}

Seams::Seam seam_of_script(const PythonParams& params, const EnergyVolume& energy, Window window,
                           Context& context) {
    const Columns columns(energy);
    const auto width = static_cast<std::size_t>(window.size()), entries = columns.count() * width;
    // An entry is the first vertex of a slab; the slab's other vertices lie behind it.
    const auto& seen = energy.seen();
    const Window vertices{window.first, window.last + seen.width() - energy.width()};
    const auto in_field = script_takes(params, "field") && seen.has_field()
                              ? columns.count() * static_cast<std::size_t>(vertices.size())
                              : 0;
    if (!grid_fits(static_cast<double>((entries + in_field) * sizeof(float)),
                   context.memory_budget()))
        throw Failure(fmt::format(
            "the energy has {} entries, more than --memory allows; raise it, or state `finest: 2`",
            entries));
    std::vector<std::uint16_t> at(columns.count());
    std::string fault;
    call_script(
        params, "seam", context,
        [&](Worker& worker) {
            auto* const to =
                reinterpret_cast<float*>(worker.given.grown((entries + in_field) * sizeof(float)));
            auto* const behind = energy.summed() ? write_costs<float>(energy, window, to)
                                                 : write_costs<std::uint16_t>(energy, window, to);
            const auto array = [&](std::size_t at, int last) {
                return Json{
                    {"at", at * sizeof(float)},
                    {"type", "float32"},
                    {"shape", {columns.frames(), columns.slices(), columns.laterals(), last}}};
            };
            Json arrays{{"energy", array(0, window.size())}};
            if (in_field > 0) {
                write_field(seen, vertices, behind);
                arrays["field"] = array(entries, vertices.size());
            }
            return Json{{"wants", "entries"}, {"bytes", worker.given.size()}, {"arrays", arrays}};
        },
        [&](Worker& worker, const Json&) {
            const auto* const found = reinterpret_cast<const std::int32_t*>(
                worker.answered.seen(at.size() * sizeof(std::int32_t)));
            for (std::size_t n = 0; n < at.size() && fault.empty(); ++n) {
                if (found[n] < 0 || found[n] >= window.size())
                    fault = fmt::format("entry {} at {} is not from 0 to {}", found[n],
                                        place_text(columns, n), window.size() - 1);
                at[n] = static_cast<std::uint16_t>(found[n] + window.first);
            }
            if (fault.empty())
                fault = fault_of_seam(at, reinterpret_cast<const float*>(worker.given.grown(0)),
                                      window, columns);
        });
    if (!fault.empty())
        throw Failure(fmt::format("{}: seam returned entries [t, k, j] that are no seam: {}",
                                  params.script.at(0), fault));
    const auto sum = energy_of(energy, at);
    return {std::move(at), sum};
}

struct SeamPython : SeamNode {
    struct Params : SeamNode::Params, PythonParams {};

    static void check(const Params& params, NodeCheck& check) {
        SeamNode::check(params, check);
        // Static seams are found in the sum of all frames, which has no field.
        const bool has_field = check.stated("field") && !params.static_ && !params.pair_static &&
                               params.cost.value_or(Cost::forward) == Cost::forward;
        check_script(params, "seam", {"energy"}, check,
                     has_field ? std::vector<std::string>{"field"} : std::vector<std::string>{});
    }
    static Further depends(const Params& params) { return script_depends(params); }
    void finish(const Params& params, Ports& io, Context& context) {
        solve(params, io, context,
              [&](const EnergyVolume& energy, Window window, int, const Tick& tick) {
                  tick(0);
                  return seam_of_script(params, energy, window, context);
              });
    }
};

}  // namespace

NodeType seam_python() {
    Declare<SeamPython> node(
        "seam.python",
        "Finds seams by your own function in Python, `seam(energy, at)`. It is called once for "
        "each seam, with what each entry costs, an array [t, k, j, entry]: inf is protected, below "
        "0 attracted. It returns the seam's entries, whole numbers [t, k, j], which may differ by "
        "at most 1 between neighbours. With a `field`, and neither `static` nor `cost: backward`, "
        "a function `seam(energy, field, at)` also gets what is seen, [t, k, j, vertex]. Where "
        "seams are thick, an entry is the slab that begins there, so that `field` is longer. Of "
        "seams "
        "of frames (`axis: t`) arrays are [i, k, j, frame].");
    return declare_python(declare_solver(node));
}

}  // namespace fluidcarve
