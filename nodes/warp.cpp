#include "nodes/warp.h"

#include "carve/solver/costs/width.h"
#include "carve/solver/task/gathered_energy.h"
#include "carve/solver/task/space.h"
#include "carve/solver/task/task.h"
#include "carve/volume/volume.h"
#include "carve/warp/find_warp.h"
#include "carve/warp/weights.h"
#include "graph/types/node_type.h"
#include "nodes/params/param_forms.h"
#include "nodes/params/warp_params.h"
#include "nodes/solving/foreseen.h"
#include "nodes/solving/growth_of.h"
#include "nodes/solving/seam_node.h"
#include "nodes/solving/warp_report.h"
#include "nodes/solving/warp_task.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

namespace {

using Json = nlohmann::ordered_json;

/// Converts amounts to item counts of Growth: a larger request has a higher count. A single amount
/// squeezes the lattice if it is negative, so counts rise with falling amounts. With pairs of
/// windows either sign squeezes one, and each sign has results of its own.
class Reach {
public:
    static constexpr std::size_t nothing = 0;
    static constexpr std::size_t one_amount = 1;  ///< of a curve, or of a warp that is not linear

    static std::size_t of(double amount, bool paired) {
        const double steps =
            std::clamp((paired ? std::abs(amount) : -amount) / warp_amount_step, -zero, most);
        return static_cast<std::size_t>(std::floor(steps + (paired ? 0 : zero)) + first);
    }
    /// The reverse. @param sign  of a pair's amount
    static double amount(std::size_t count, bool paired, double sign) {
        const double steps = static_cast<double>(count) - first;
        return warp_amount_step * (paired ? std::copysign(steps, sign) : zero - steps);
    }

private:
    static constexpr double first = 2, zero = 0x1p33, most = 0x1p33;
};

/// The amount still to be made after other sets; with `rest`, these count towards the amount.
WarpAmount amount_left(const WarpParams& params, WarpAmount amount, const CarvedSpace& space) {
    if (!params.rest) return amount;
    const auto axis = dimension(params.axis);
    const int before = space.lattices().front()->shape[axis], now = space.shape()[axis];
    amount.constant = {amount.constant.exactly(before) - (now - before), false};
    return amount;
}

struct WarpSolve {
    using Params = WarpParams;
    struct Ports : SeamNode::Ports {
        Optional<FloatGrid> content;
    };

    static void check(const Params& params, NodeCheck& check) { check_params(params, check); }

    static void survey(const Params& params, Survey& survey) {
        if (params.amount) return;
        try {
            amount_of(params);
        } catch (const Failure& failure) {
            survey.missing(survey.frames().front(), failure.what());
        }
    }

    static void foresee(const Params& params, Outlook& ahead) {
        if (states_nothing(params)) return;
        deliver_warp(params.static_, ahead);
        warn_of_placement(ahead);
        auto form = received_form(ahead);
        if (form.shape[dimension(params.axis)] == 0 || !ahead.receives("after").empty()) return;
        // One amount is that of all planes, however many there are.
        form.shape[2] = std::max(form.shape[2], 1);
        // Curves need planes and frames, percentages may need the content: both are known later.
        auto amount = params.amount.value_or(WarpAmount{});
        if (amount.varies()) amount = {};
        else if (!ahead.receives("content").empty()) amount = amount.in_vertices(0);
        try {
            require_ends(gathering_params(params), form);
            require_fits(params, amount, form.shape, form.closed, {0}, "");
        } catch (const Failure& failure) {
            ahead.fault(failure.what());
        }
    }

    static std::shared_ptr<FrameEnergy> digest(const Params& params, const Ports& io,
                                               Context& context) {
        // The first frame shows faults before all others are read.
        if (context.t() == 0 && !states_nothing(params)) {
            // The space after other seams is known only later, as are percentages of the content.
            if (io.after.empty()) {
                const auto stated = amount_of(params);
                require_fits(params, io.content ? stated.in_vertices(0) : stated, io.lattice->shape,
                             io.lattice->closed, context.frames(), "");
            }
            require_ends(gathering_params(params), io.lattice->form());
        }
        const auto grids = grids_of(io);
        require_frame_fits(grids, *io.lattice, context.limits().memory);
        const auto out = std::make_shared<FrameEnergy>(
            sample_frame(grids, io.lattice, params.axis, Measure::vertex));
        if (io.content) out->width = width_in(*io.content, *io.lattice, params.axis);
        return out;
    }

    void add(const Params& params, const Ref<FrameEnergy>& frame, Context& context) {
        gathered_.add(gathering_params(params), *frame,
                      {context.frame(), context.t(), context.frames().size()}, context.limits());
        if (frame->width.value_or(0) > 0) widths_.push_back(*frame->width);
    }

    /// Takes an earlier warp, if it is not linear: it may be the wanted one.
    void resume(const Payload& result, const Json& entry) {
        before_ = result.as<Seams>();
        entry_ = entry;
    }

    void finish(const Params& params, Ports& io, Context& context) {
        const CarvedSpace space(gathered_.lattices(), io.after, context.frames());
        auto amount = amount_of(params);
        if (!widths_.empty())
            amount = amount.in_vertices(std::accumulate(widths_.begin(), widths_.end(), 0.0) /
                                        static_cast<double>(widths_.size()));
        amount = amount_left(params, amount, space);
        const bool nothing = amount.nothing();
        const auto shape = space.shape();
        if (!nothing) {
            require_fits(params, amount, shape, space.lattices().front()->closed, space.frames(),
                         once_carved(space.carved()));
            gathered_.require_met();
            for (const auto& warning : gathered_.warnings()) context.warn_at_once(warning);
        }
        const int size = shape[dimension(params.axis)];
        const bool found_before =
            before_ && before_->warp && !before_->warp->linear() && !amount.varies() &&
            entry_.value("amount", 0.0) == in_steps(amount.constant.exactly(size));
        auto set = found_before ? *before_ : empty_warp(params, space);
        auto report = entry_;
        if (!found_before) {
            // A curve may differ from 0 only between planes or frames.
            const bool moves = !nothing && amounts_in(set, amount) != std::pair(0.0, 0.0);
            report = moves ? solve(params, amount, space, set, context)
                           : warp_report(set, params, nothing ? nullptr : &amount);
        }
        if (const auto fault = space.extension_fault(set); !fault.empty()) context.warn(fault);
        for (const auto& warning : warnings(report)) context.warn(warning);
        context.report("warp", report);
        io.seams = std::make_shared<Seams>(std::move(set));
    }

    /// A linear warp serves every amount up to the limit of squeezing.
    static std::string rest(const Params& params) {
        if (!params.amount) return "of a file";
        if (params.rest) return "rest of " + to_text(*params.amount);
        if (one_of_a_kind(*params.amount)) return to_text(*params.amount);
        return params.pair_window ? params.amount->constant.value < 0 ? "squeezes" : "draws out"
                                  : "";
    }
    static ItemCount item_count(const Payload& result) {
        const auto set = result.as<Seams>();
        const auto all = static_cast<std::size_t>(set->before());
        if (!set->warp) return {Reach::nothing, all};
        if (!set->warp->linear()) return {Reach::one_amount, all};
        const bool paired = set->pair_window.has_value();
        const int sign = paired && set->warp->scale() > 0 ? 1 : -1;
        return {Reach::of(sign * most_linear(*set->warp, sign), paired), all};
    }
    static std::size_t wanted(const Params& params, std::size_t vertices) {
        if (states_nothing(params)) return Reach::nothing;
        return !params.amount || one_of_a_kind(*params.amount) || params.rest
                   ? Reach::one_amount
                   : Reach::of(
                         in_steps(params.amount->constant.exactly(static_cast<int>(vertices))),
                         params.pair_window.has_value());
    }
    static Payload first(const Payload& result, std::size_t count, Json& entry) {
        const auto set = std::make_shared<Seams>(*result.as<Seams>());
        if (count == Reach::nothing) {
            set->warp.reset();
            entry = warp_report(*set, {}, nullptr);
        } else if (set->warp && set->warp->linear()) {
            auto& warp = *set->warp;
            warp.set_scale(Reach::amount(count, set->pair_window.has_value(), warp.scale()));
            entry["amount"] = warp.scale();
            entry["steepest"] = steepest(warp);
        }
        return Payload(Ref<Seams>(set));
    }
    /// Warnings from a report. After other seams the rest of an amount may be 0.
    static std::vector<std::string> warnings(const Json& entry) {
        if (entry.value("amount", Json()) != 0.0 || entry.contains("rest")) return {};
        return {"`amount` is 0, so that nothing is carved"};
    }

private:
    /// Whether an amount has a result of its own: a percentage may count content.
    static bool one_of_a_kind(const WarpAmount& amount) {
        return amount.varies() || amount.has_percent();
    }

    /// Finds the warp of a set. @return its report
    Json solve(const Params& params, const WarpAmount& amount, const CarvedSpace& space, Seams& set,
               Context& context) {
        const auto begin = std::chrono::steady_clock::now();
        auto sampled = gathered_.take_sampled(gathering_params(params), space, context.limits());
        const auto frames = params.static_ ? std::size_t{1} : set.frames.size();
        const int factor = warp_factor_for(params, set, frames);
        auto& warp = set.warp.emplace(set.warp_vertices(), set.warp_rings(), factor, frames,
                                      context.limits());
        FrameStore weights(frames, warp.values(0).size(), context.limits());
        find_weights(sampled.energy, sampled.typical,
                     {params.field_weight, params.evenness, params.empty}, warp, weights);
        const auto task = warp_task(params, amount, set, warp);
        if (const auto none = no_room(task, warp, weights))
            throw Failure(no_room_text(*none, params, set, space));
        const int cycles = find_warp(task, warp, weights, [&](double done) {
            context.check_cancelled();
            context.progress(done);
        });
        // A warp for a curve, or for the rest of an amount, serves no other amount.
        if (!params.amount || one_of_a_kind(*params.amount) || params.rest) warp.set_linear(false);
        if (!set.pair_window) warp.anchor_at(params.anchor);
        warp.find_bounds();
        auto report = warp_report(set, params, &amount);
        if (!amount.varies()) report["amount"] = task.amount;
        report["linear"] = warp.linear();
        report["cycles"] = cycles;
        if (const auto& marks = gathered_.marks(); marks.protect || marks.attract) {
            if (marks.protect) report["protected"] = *marks.protect;
            if (marks.attract) report["attracted"] = *marks.attract;
        }
        report["wall_s"] =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        return report;
    }

    GatheredEnergy gathered_;
    std::vector<int> widths_;  ///< of the content, frame by frame
    Ref<Seams> before_;        ///< found by an earlier run
    Json entry_;               ///< its report
};

}  // namespace

NodeType warp_solve() {
    using Ports = WarpSolve::Ports;
    using Params = WarpParams;
    return Declare<WarpSolve>("warp.solve",
                              "Finds a displacement of all vertices as a whole, in place of seams: "
                              "it squeezes or draws out most where that is seen least. The amount "
                              "need not be whole, and may change along the lattice and over time.")
        .input("energy", &Ports::energy,
               "The energy, 0 or more: space of high energy keeps its shape. It is sampled at the "
               "lattice's vertices.")
        .input("lattice", &Ports::lattice, "The space that is carved.")
        .input("field", &Ports::field,
               "The grid that is seen, such as the density; sampled at the vertices. With it, "
               "edges are stiff, too (`field_weight`), and empty space is where it shows nothing "
               "(`empty`); without it, where the energy is 0.")
        .input(
            "protect", &Ports::protect,
            "What moves rigidly: a mask, or the active voxels of any grid. A vertex is protected "
            "if any of the 8 voxels around it is set; a vertex on a voxel, if that voxel is set.")
        .input("attract", &Ports::attract,
               "What gives first: a mask or any grid, as for `protect`, which has precedence.")
        .input(
            "after", &Ports::after,
            "Sets of seams, or warps, of this lattice that are carved before, in order. The warp "
            "is found in the space that they leave; windows and amounts count its vertices.")
        .input("content", &Ports::content,
               "What percentages of `amount` count: how wide this is in the lattice, in the "
               "median of all planes that show it. Inside of a level set, or where another grid "
               "exceeds 2 % of its greatest value. Left out, they count the lattice's vertices.")
        .param("axis", &Params::axis,
               "The dimension of the lattice that shrinks or grows: u or v, across the rig; w, "
               "along it.")
        .param(
            "amount", &Params::amount, Unit::vertices, any_number(),
            "By how much the lattice grows along the axis: negative shrinks. A number of vertices, "
            "such as -7.25, or N%, a share of the width of `content`. Or a curve, {along: w, "
            "at: [[0, 0], [0.4, -12], [1, -12]]}: amounts at places along the lattice, from 0, the "
            "first plane, to 1, the last one; with `along: time`, at frame numbers. Between its "
            "points a curve is linear, beyond them constant. `over: [[1001, 0], [1024, 1]]` in it "
            "multiplies it by factors along the other dimension. Where a curve is 0, nothing "
            "moves. auto takes the amount from `amount_file`; one of the two is stated.")
        .param("amount_file", &Params::amount_file,
               "A .csv file with such a curve, in place of `amount`. Its first line names the "
               "columns: `amount` and `w` or `time`; each further line is a point. With both `w` "
               "and `time`, each frame named has a curve of its own along the lattice, and frames "
               "between them what lies between; the lines of a frame stand together.")
        .param("rest", &Params::rest,
               "Whether the sets of `after` count towards `amount`: the warp then makes what they "
               "leave of it, such as a fraction, or all that seams do worse (`seams.choose`).")
        .param("window", &Params::window, Unit::vertices, any_number(),
               "First and last vertex along the axis between which space is squeezed or drawn out, "
               "or shares, [0%, 50%], which hold for any spacing; auto is all vertices.")
        .param("pair_window", &Params::pair_window, Unit::vertices, any_number(),
               "A second window, above the first. What is taken from one is given to the other: "
               "only the content in them and between them moves, and the size stays. Or two, "
               "[[0%, 20%], [80%, 100%]], one below `window` and one above it: each gives one "
               "half, and the middle stays, as a river between its banks. auto is none.")
        .param("static", &Params::static_,
               "Whether the warp is the same in all frames. It is then found by the mean stiffness "
               "over all frames.")
        .param("anchor", &Params::anchor,
               "What stays in place while the rest moves: the lattice's low end, its middle, its "
               "high end, or a vertex; in each column and frame.")
        .param("field_weight", &Params::field_weight, Unit::none, between(0, 1e4),
               "How much edges of the field count. At 1, an edge of the mean size found in the "
               "content is as stiff as the content's mean energy makes it.")
        .param("evenness", &Params::evenness, Unit::none, between(1e-4, 1e4),
               "Stiffness that all content has alike, in units of what its mean energy makes. "
               "More: closer to even scaling. Less: more is squeezed where the energy is low.")
        .param("empty", &Params::empty, Unit::none, between(1e-4, 1e4),
               "Stiffness of a vertex without content, as a share of the mean stiffness of "
               "vertices with content. Higher: the content itself becomes narrower or wider. "
               "Lower: more is taken from the space around it.")
        .param("stiffness", &Params::stiffness, Unit::none, between(0, 1e4),
               "Stiffness against shear between columns, as a share of that against squeezing. "
               "More: neighbouring columns are squeezed at the same places.")
        .param("stiffness_time", &Params::stiffness_time, Unit::none, between(0, 1e4),
               "The same from frame to frame. More is steadier.")
        .param("factor", &Params::factor, Unit::vertices, any_number(),
               "The warp is found at every vertex (1), every second (2) or every fourth one (4), "
               "and is linear between. auto takes the lowest that makes at most 64 million points; "
               "the report tells it.")
        .output("seams", &Ports::seams, "The warp; all that takes seams takes it.")
        .digests({"energy", "lattice", "field", "protect", "attract", "content", "axis"})
        .grows(growth_of<WarpSolve>("amount", "amount"))
        .in_place()
        .kept()
        .version(3);
}

}  // namespace fluidcarve
