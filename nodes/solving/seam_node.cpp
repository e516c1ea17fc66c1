#include "nodes/solving/seam_node.h"

#include "carve/solver/task/space.h"
#include "carve/solver/task/task.h"
#include "nodes/solving/foreseen.h"
#include "nodes/solving/report.h"
#include "nodes/solving/solve_task.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <cstdlib>
#include <utility>

namespace fluidcarve {

namespace {

std::string half_size_note(const CarvedSpace& space) {
    return fmt::format(
        "solves at half size, since a frame of the lattice has {} vertices: seams come in pairs, "
        "side by side; `finest: 1` solves at full size, and takes about 16 times the memory and "
        "time",
        fmt::join(space.lattices().front()->shape, " x "));
}

}  // namespace

void SeamNode::foresee(const Params& params, Outlook& ahead) {
    if (params.count.value == 0) return;
    warn_of_placement(ahead);
    auto form = received_form(ahead);
    form.frames = static_cast<int>(ahead.frames());
    const bool known = params.axis == Axis::t || form.shape[dimension(params.axis)] > 0;
    if (!known || !ahead.receives("after").empty()) return;
    try {
        task_of(params_for(params, !ahead.receives("field").empty(), ahead.frames()), form, false);
    } catch (const Failure& failure) {
        ahead.fault(failure.what());
    }
}

std::optional<FrameCarvePromise> SeamNode::in_time(const Params& params) {
    if (params.axis != Axis::t) return std::nullopt;
    return FrameCarvePromise{params.count, params.pair_window.has_value()};
}

std::shared_ptr<FrameEnergy> SeamNode::digest(const Params& params, const Ports& io,
                                              Context& context) {
    // The first frame shows faults before all others are read. The space after other seams is
    // known only later.
    if (context.t() == 0) {
        auto form = io.lattice->form();
        form.frames = static_cast<int>(context.frames().size());
        if (io.after.empty())
            task_of(params_for(params, io.field != nullptr, context.frames().size()), form, false);
        else require_ends(params, form);
    }
    const auto grids = grids_of(io);
    const int finest = finest_for(params, *io.lattice);
    require_frame_fits(grids, *io.lattice, context.limits().memory, finest);
    return std::make_shared<FrameEnergy>(
        sample_frame(grids, io.lattice, params.axis, params.measure, finest));
}

void SeamNode::resume(const Payload& result, const nlohmann::ordered_json& entry) {
    before_ = {result.as<Seams>(), entry};
    end_shortfall(before_.report);
}

ItemCount SeamNode::item_count(const Payload& result) {
    const auto seams = result.as<Seams>();
    return {seams->seams.size(), static_cast<std::size_t>(seams->before())};
}

std::size_t SeamNode::wanted(const Params& params, std::size_t vertices) {
    return static_cast<std::size_t>(std::abs(params.count.of(static_cast<int>(vertices))));
}

Payload SeamNode::first(const Payload& result, std::size_t count, nlohmann::ordered_json& entry) {
    auto out = ReportedSeams{result.as<Seams>(), entry}.first(count);
    entry = std::move(out.report);
    return Payload(std::move(out.seams));
}

std::vector<std::string> SeamNode::warnings(const nlohmann::ordered_json& entry) {
    return seam_warnings(entry);
}

bool SeamNode::exhausted(const nlohmann::ordered_json& entry) { return falls_short(entry); }

void SeamNode::solve(const Params& stated, Ports& io, Context& context, const FindSeam& find,
                     const StartFrom& start_from) {
    const CarvedSpace space(gathered_.lattices(), io.after, context.frames());
    const auto params = params_for(stated, gathered_.has_field(), context.frames().size());
    const int finest = gathered_.finest();
    const auto task = task_of(params, space, finest);
    auto empty = empty_seams(params, task, space);
    ReportedSeams found{std::make_shared<Seams>(empty), empty_report(empty)};
    if (task.count > 0) {
        gathered_.require_met();
        // Before the search, which may take long.
        for (const auto& warning : gathered_.warnings()) context.warn_at_once(warning);
        if (finest > 1 && !params.finest) context.warn_at_once(half_size_note(space));
        auto [energy, thick, thickness] = gathered_.take_priced(params, space, context.limits());
        empty.thickness = thickness;
        // Seams of full size do not tell the seams of half size that they came from.
        if (finest > 1) before_ = {};
        // An unfinished larger set may hold more pairs than are wanted.
        if (before_.seams) before_ = before_.first(static_cast<std::size_t>(task.count));
        found = solve_task(energy,
                           {.task = task,
                            .space = space,
                            .empty = empty,
                            .before = before_,
                            .marks = gathered_.marks(),
                            .find = find,
                            .start_from = start_from,
                            .bound_passes = params.bound_passes,
                            .checkpoint_after = checkpoint_after_,
                            .best_effort = params.best_effort,
                            .thick = thick},
                           context);
    }
    if (task.count < task.asked && !falls_short(found.report))
        set_shortfall(found.report, static_cast<std::size_t>(task.asked), task.limit);
    for (const auto& warning : seam_warnings(found.report)) context.warn(warning);
    if (const auto fault = space.extension_fault(*found.seams); !fault.empty()) context.warn(fault);
    context.report("seams", found.report);
    io.seams = std::move(found.seams);
}

}  // namespace fluidcarve
