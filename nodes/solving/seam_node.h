#pragma once

#include "carve/solver/search/find_seams.h"
#include "carve/solver/task/gathered_energy.h"
#include "carve/solver/task/params.h"
#include "carve/time/frame_carve_promise.h"
#include "carve/volume/volume.h"
#include "graph/types/node_type.h"
#include "nodes/params/check_params.h"
#include "nodes/solving/reported_seams.h"

#include <nlohmann/json.hpp>

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// The grids that a solver's inputs hold.
FrameGrids grids_of(const auto& io) {
    const auto mask = [](const Ref<AnyGrid>& port) { return port ? port->grid.get() : nullptr; };
    return {*io.energy, io.field.get(), mask(io.protect), mask(io.attract)};
}

/// The base of all solver nodes (METHOD 8): their ports, and how a run calls them. The work that
/// does not depend on how one seam is found is in carve/solver/task and here: windows, pairs,
/// static seams, masks, and the space that earlier seams leave. A new solver is a FindSeam with
/// its own parameters and a node:
///
///     struct Mine : SeamNode {
///         struct Params : SeamNode::Params { int passes = 3; };
///         void finish(const Params& params, Ports& io, Context& context) {
///             solve(params, io, context, my_seam...);
///         }
///     };
///     NodeType seam_mine() {
///         Declare<Mine> node("seam.mine", "...");
///         return declare_solver(node).param("passes", &Mine::Params::passes, ...);
///     }
class SeamNode {
public:
    using Params = SolverParams;
    struct Ports {
        Ref<FloatGrid> energy;
        Ref<Lattice> lattice;
        Optional<FloatGrid> field;
        Optional<AnyGrid> protect, attract;
        OptionalList<Seams> after;
        Ref<Seams> seams;
    };

    static void check(const Params& params, NodeCheck& check) { check_params(params, check); }
    /// Warns of an energy without content, and of a lattice beside the content, as far as the
    /// headers of files tell.
    static void foresee(const Params& params, Outlook& ahead);
    /// The effect of seams of frames on their sequence; nothing for other seams.
    static std::optional<FrameCarvePromise> in_time(const Params& params);
    /// One frame's energy at the lattice's vertices, with its field and masks.
    static std::shared_ptr<FrameEnergy> digest(const Params& params, const Ports& io,
                                               Context& context);
    void add(const Params& params, const Ref<FrameEnergy>& frame, Context& context) {
        gathered_.add(params, *frame, {context.frame(), context.t(), context.frames().size()},
                      context.limits());
    }
    /// Continues from seams that were found before, with the same energy and parameters except
    /// `count`.
    /// @param result  the seams
    /// @param entry   their report
    void resume(const Payload& result, const nlohmann::ordered_json& entry);

    /// Seams are a result that grows (Growth): the first seams do not depend on how many are asked
    /// for.
    static std::string rest(const Params& params) {
        return to_text(kind_asked(params.count.value));
    }
    static ItemCount item_count(const Payload& result);
    static std::size_t wanted(const Params& params, std::size_t vertices);
    static Payload first(const Payload& result, std::size_t count, nlohmann::ordered_json& entry);
    /// Warnings about a set of seams, made from its report.
    static std::vector<std::string> warnings(const nlohmann::ordered_json& entry);
    /// Whether a set's report says that there are no more seams.
    static bool exhausted(const nlohmann::ordered_json& entry);

protected:
    /// Finds the seams and reports them under `seams` (report.h).
    /// @param start_from  for solvers that start from the previous seam
    void solve(const Params& params, Ports& io, Context& context, const FindSeam& find,
               const StartFrom& start_from = nullptr);

    /// Shortest time between two calls of Context::checkpoint.
    std::chrono::milliseconds checkpoint_after_ = std::chrono::seconds(5);

private:
    GatheredEnergy gathered_;
    ReportedSeams before_;  ///< found by an earlier run
};

}  // namespace fluidcarve
