#include "nodes/python/python_nodes.h"

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
    return fmt::format("[{}, {}, {}]", at.t, at.slice, at.lateral);
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
        for (const auto beside : columns.neighbours(n, columns.place(n)))
            if (beside != Columns::none && std::abs(at[n] - at[beside]) > 1)
                return fmt::format(
                    "entries {} and {} at the neighbours {} and {} differ by more than 1", entry,
                    at[beside] - window.first, place_text(columns, n), place_text(columns, beside));
    }
    return {};
}

/// One call of a script's function `seam`: what it is given, and what it answers.
class SeamCall {
public:
    SeamCall(const PythonParams& params, const EnergyVolume& energy, Window window)
        : energy_(energy),
          window_(window),
          vertices_{window.first, window.last + energy.seen().width() - energy.width()},
          columns_(energy),
          entries_(columns_.count() * static_cast<std::size_t>(window.size())),
          in_field_(script_takes(params, "field") && energy.seen().has_field()
                        ? columns_.count() * static_cast<std::size_t>(vertices_.size())
                        : 0) {}

    void require_room(std::uint64_t budget) const {
        if (!grid_fits(static_cast<double>(bytes()), budget))
            throw Failure(
                fmt::format("the energy has {} entries, more than --memory allows; raise "
                            "it, or state `finest: 2`",
                            entries_));
    }
    /// Writes the arrays. @return where they are
    Json give(Worker& worker) const {
        auto* const to = reinterpret_cast<float*>(worker.given.grown(bytes()));
        auto* const behind = energy_.summed() ? write_costs<float>(energy_, window_, to)
                                              : write_costs<std::uint16_t>(energy_, window_, to);
        Json arrays{{"energy", array(0, window_.size())}};
        if (in_field_ > 0) {
            write_field(energy_.seen(), vertices_, behind);
            arrays["field"] = array(entries_, vertices_.size());
        }
        return Json{{"wants", "entries"}, {"bytes", worker.given.size()}, {"arrays", arrays}};
    }
    void take(Worker& worker) {
        at_.resize(columns_.count());
        const auto* const found = reinterpret_cast<const std::int32_t*>(
            worker.answered.seen(at_.size() * sizeof(std::int32_t)));
        for (std::size_t n = 0; n < at_.size() && fault_.empty(); ++n) {
            if (found[n] < 0 || found[n] >= window_.size())
                fault_ = fmt::format("entry {} at {} is not from 0 to {}", found[n],
                                     place_text(columns_, n), window_.size() - 1);
            at_[n] = static_cast<std::uint16_t>(found[n] + window_.first);
        }
        if (fault_.empty())
            fault_ = fault_of_seam(at_, reinterpret_cast<const float*>(worker.given.grown(0)),
                                   window_, columns_);
    }
    /// What is wrong with the answer; empty: nothing.
    const std::string& fault() const { return fault_; }
    Seams::Seam seam() && {
        const auto sum = energy_of(energy_, at_);
        return {std::move(at_), sum};
    }

private:
    std::size_t bytes() const { return (entries_ + in_field_) * sizeof(float); }
    Json array(std::size_t at, int last) const {
        return Json{{"at", at * sizeof(float)},
                    {"type", "float32"},
                    {"shape", {columns_.frames(), columns_.slices(), columns_.laterals(), last}}};
    }

    const EnergyVolume& energy_;
    Window window_;
    Window vertices_;  ///< a slab is at its first vertex; behind the last are those that it holds
    Columns columns_;
    std::size_t entries_, in_field_;  ///< numbers handed over
    std::vector<std::uint16_t> at_;   ///< the seam
    std::string fault_;
};

Seams::Seam seam_of_script(const PythonParams& params, const EnergyVolume& energy, Window window,
                           Context& context) {
    SeamCall call(params, energy, window);
    call.require_room(context.limits().memory);
    call_script(
        params, "seam", context, [&](Worker& worker) { return call.give(worker); },
        [&](Worker& worker, const Json&) { call.take(worker); });
    if (!call.fault().empty())
        throw Failure(fmt::format("{}: seam returned entries [t, k, j] that are no seam: {}",
                                  params.script.at(0), call.fault()));
    return std::move(call).seam();
}

struct SeamPython : SeamNode {
    struct Params : SeamNode::Params, PythonParams {};

    static void check(const Params& params, NodeCheck& check) {
        SeamNode::check(params, check);
        // Static seams are found in the sum of all frames, which has no field.
        const bool has_field = check.stated("field") && !params.static_ && !params.pair_static &&
                               params.cost.value_or(CostMode::forward) == CostMode::forward;
        check_script(params, "seam", {"energy"}, check,
                     has_field ? std::vector<std::string>{"field"} : std::vector<std::string>{});
    }
    static NodeTraits traits(const Params& params) { return script_traits(params); }
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
        "seams of frames (`axis: t`) arrays are [i, k, j, frame].");
    return declare_python(declare_solver(node));
}

}  // namespace fluidcarve
