#include "nodes/params/check_params.h"

#include "carve/seam/seams.h"

#include <fmt/format.h>

#include <cmath>
#include <tuple>
#include <utility>

namespace fluidcarve {

bool check_corners(const Vec3& min, const Vec3& max, std::size_t dimension, NodeCheck& check) {
    if (min[dimension] <= max[dimension]) return true;
    check.fault("max", fmt::format("'max' is below 'min' in {}: {:.10g} < {:.10g}",
                                   "xyz"[dimension], max[dimension], min[dimension]));
    return false;
}

void check_corners(const Vec3& min, const Vec3& max, NodeCheck& check) {
    for (std::size_t n = 0; n < 3; ++n) check_corners(min, max, n, check);
}

void check_direction(const char* field, const Vec3& direction, NodeCheck& check) {
    if (const double length = openvdb::Vec3d(direction.data()).length();
        !(length > 0 && std::isfinite(length)))
        check.fault(field, fmt::format("'{}' has no direction", field));
}

void check_anchor(const Anchor& anchor, NodeCheck& check) {
    if (anchor.vertex < 0)
        check.fault("anchor",
                    fmt::format("parameter 'anchor' must be low, middle, high or a vertex from 0 "
                                "on, not {}",
                                anchor.vertex));
}

namespace {

/// Reports parameters that make no sense for seams of frames.
void check_in_time(const SolverParams& params, NodeCheck& check) {
    for (const auto& [stated, name, why] :
         {std::tuple(params.static_, "static", "each place loses or gains other frames"),
          std::tuple(params.pair_static, "pair_static", "each place loses or gains other frames"),
          std::tuple(check.stated("anchor"), "anchor", "the first frame keeps its number"),
          std::tuple(check.stated("rigidity_time"), "rigidity_time",
                     "steps are from place to place, and cost `rigidity`"),
          std::tuple(params.finest == 2, "finest", "seams are found at full size"),
          std::tuple(params.best_effort, "best_effort",
                     "the number of frames must be known before the run")})
        if (stated)
            check.fault(name, fmt::format("parameter '{}' is not for `axis: t`, where {}: leave it "
                                          "out",
                                          name, why));
    if (check.connections("after") > 0)
        check.fault("after",
                    "input 'after' is not for `axis: t`: seams of frames are found in the sequence "
                    "as it is; carve frames by one remap.grids, and carve its result in space by "
                    "other nodes");
}

void check_windows(const SolverParams& params, NodeCheck& check) {
    if (params.pair_window && check.stated("anchor"))
        check.fault("anchor", "pairs of seams move neither end of the lattice: leave 'anchor' out");
    if (params.pair_window && !params.window)
        check.fault("pair_window",
                    "parameter 'pair_window' needs a 'window' beside it, below it on the axis");
    // Shares are vertices only once the lattice is known.
    const auto window = vertices_of(params.window), pair_window = vertices_of(params.pair_window);
    if (window && pair_window)
        if (const auto fault =
                pair_fault(*window, *params.window, *pair_window, *params.pair_window, false))
            check.fault("pair_window", *fault);
    if (params.pair_static && !params.pair_window)
        check.fault("pair_static", "parameter 'pair_static' needs a 'pair_window'");
}

/// @param forward  whether costs are those of the edges that seams leave behind
void check_field(bool forward, bool field, NodeCheck& check) {
    if (forward && !field)
        check.fault(
            "cost",
            "cost 'forward' needs a `field`, in which it counts the edges that seams leave behind");
    if (!forward && field)
        check.fault("field",
                    "input 'field' serves `cost: forward`, but `cost` is backward: leave one of "
                    "the two out");
    for (const auto* const name : {"field_weight", "empty"})
        if (!forward && check.stated(name))
            check.fault(
                name,
                fmt::format("parameter '{}' needs a `field`, in which content and edges are seen",
                            name));
}

void check_thick(const SolverParams& params, bool field, NodeCheck& check) {
    const int thickness = params.thickness.value_or(1);
    if (thickness > 1 && !field)
        check.fault("thickness",
                    "thick seams need a `field`: they run where it looks alike on both sides");
    for (const auto* const name : {"cost", "spread"})
        if (thickness > 1 && check.stated(name))
            check.fault(
                name,
                fmt::format("parameter '{}' serves thin seams: leave it out, or set `thickness: 1`",
                            name));
    for (const auto& [name, of] : {std::pair("window", vertices_of(params.window)),
                                   std::pair("pair_window", vertices_of(params.pair_window))})
        if (of && thickness > of->size())
            check.fault("thickness", fmt::format("thickness {} is wider than {} [{}, {}], which "
                                                 "has {} vertices; lower it, or widen the window",
                                                 thickness, name, of->first, of->last, of->size()));
}

/// Finds parameters that have no effect on thin seams with costs of edges in the field.
void check_thin(const SolverParams& params, NodeCheck& check) {
    const auto window = vertices_of(params.window), pair_window = vertices_of(params.pair_window);
    if (window && pair_window && pair_window->first == window->last + 1)
        check.fault("pair_window",
                    "with a `field` there must be a vertex between window and pair_window, since a "
                    "seam at the end of one changes the edges of the other");
    if (params.static_ || params.pair_static)
        check.fault(params.static_ ? "static" : "pair_static",
                    "with a `field` the costs of thin seams are counted frame by frame, and no "
                    "static ones are found; state a `thickness`, or leave the field "
                    "out");
}

}  // namespace

void check_params(const SolverParams& params, NodeCheck& check) {
    check_anchor(params.anchor, check);
    if (params.axis == Axis::t) check_in_time(params, check);
    check_windows(params, check);
    const bool field = check.connections("field") > 0;
    const bool forward =
        params.cost.value_or(field ? CostMode::forward : CostMode::backward) == CostMode::forward;
    check_field(forward, field, check);
    check_thick(params, field, check);
    if (forward && params.thickness.value_or(1) == 1) check_thin(params, check);
}

}  // namespace fluidcarve
