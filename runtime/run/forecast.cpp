#include "runtime/run/forecast.h"

#include "carve/base/frame_set.h"
#include "carve/base/words.h"
#include "graph/text/text_table.h"
#include "runtime/run/expected_costs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace fluidcarve {
namespace {

using Json = nlohmann::ordered_json;

std::vector<Forecast::Pass> passes_of(const Pipeline& pipeline, const Plan& plan,
                                      const Schedule& schedule) {
    std::vector<Forecast::Pass> out;
    for (std::size_t p = 0; p < plan.passes.size(); ++p) {
        Forecast::Pass pass;
        std::vector<bool> runs(pipeline.nodes.size(), false);
        for (const auto& frame : schedule.frames[p]) {
            for (std::size_t n = 0; n < runs.size(); ++n) runs[n] = runs[n] || frame.reads(n);
            pass.frames += frame.empty() ? 0 : 1;
        }
        for (const auto n : plan.passes[p].per_frame)
            if (runs[n]) pass.nodes.push_back(pipeline.nodes[n].name);
        for (const auto n : plan.passes[p].gathering)
            if (runs[n] || schedule.gathers[n]) pass.gathering.push_back(pipeline.nodes[n].name);
        if (!pass.nodes.empty() || !pass.gathering.empty()) out.push_back(std::move(pass));
    }
    return out;
}

/// The estimated wall time in words.
std::string time_text(const Forecast& forecast) {
    if (forecast.unmeasured.empty()) return "about " + duration_text(forecast.seconds);
    if (!forecast.remembers) return "not known: without the work folder no run is remembered";
    if (forecast.seconds <= 0) return "not known before the first run";
    return fmt::format("at least {}, not counting nodes that never ran to their end: {}",
                       duration_text(forecast.seconds), fmt::join(forecast.unmeasured, ", "));
}

}  // namespace

Forecast make_forecast(const Pipeline& pipeline, const Preparation& prepared,
                       const Schedule& schedule, const std::vector<NodeDemand>& demands,
                       const History& history, const RunOptions& options) {
    const auto& plan = prepared.plan();
    Forecast out;
    out.pipeline = pipeline.name;
    out.frames = FrameSet(prepared.frames());
    out.delivered = FrameSet(prepared.delivered_frames());
    out.passes = passes_of(pipeline, plan, schedule);
    out.remembers = history.on();
    const auto why =
        reasons(pipeline, demands, history, prepared.dependencies(), [&](std::size_t n) {
            return NodeNow{prepared.reads(n), prepared.grown()[n]};
        });
    const auto work = work_of(schedule);
    const auto input_bytes = prepared.inputs().frame_bytes;
    out.expected = expected_costs(pipeline, input_bytes, prepared.grown(), work, history, options);
    for (std::size_t n = 0; n < demands.size(); ++n) {
        const auto& demand = demands[n];
        const auto& node = pipeline.nodes[n];
        if (demand.needed == 0) continue;
        out.lines.push_back({node.name, node.type->name, demand.needed,
                             demand.needed - demand.computed, why[n], demand.gathered(),
                             demand.consumed_digests,
                             node.type->growth ? node.type->growth->item : ""});
        const auto& cost = out.expected[n];
        bool known = true;
        out.seconds += expected_seconds(cost, work[n], known);
        if (!known) out.unmeasured.push_back(node.name);
        out.bytes += memory_of(node, cost, work[n], input_bytes, options);
        out.disk += disk_of(node, cost, work[n], input_bytes);
    }
    out.cores = options.threads;
    return out;
}

std::uint64_t memory_of(const Node& node, const NodeCost& cost, const NodeWork& work,
                        std::uint64_t input_bytes, const RunOptions& options) {
    if (!work.once && work.frames == 0 && work.consumed_inputs == 0) return 0;
    // Outputs per frame exist once per frame in flight. Digests exist until the gathering node
    // finishes, for all frames.
    const auto bytes = cost.bytes > 0 ? cost.bytes : input_bytes;
    const auto in_flight = std::min(static_cast<std::size_t>(options.in_flight),
                                    std::max(work.frames, work.consumed_inputs));
    return work.once && node.type->digest != typeid(void) && node.rate != Rate::frame
               ? std::min(options.memory, bytes * work.gathered())
               : bytes * std::max<std::size_t>(1, in_flight);
}

std::uint64_t disk_of(const Node& node, const NodeCost& cost, const NodeWork& work,
                      std::uint64_t input_bytes) {
    const bool writer = node.outputs.empty();
    const auto bytes = cost.bytes > 0 && !writer ? cost.bytes : input_bytes;
    const auto results =
        writer || node.kept ? work.frames + (work.once && node.rate != Rate::frame ? 1 : 0) : 0;
    return bytes * (results + (digests_apart(node) ? work.consumed_inputs : 0));
}

std::string to_text(const Forecast& forecast) {
    const auto total = forecast.frames.frames().size();
    std::string out =
        fmt::format("{}: {}, frames {} ({})", forecast.pipeline,
                    counted(forecast.lines.size(), "node"), forecast.frames.text(), total);
    if (const auto count = forecast.delivered.frames().size(); count < total)
        out += fmt::format(", of which {} {} delivered", forecast.delivered.text(),
                           count == 1 ? "is" : "are");
    out += "\n\n";
    std::vector<std::vector<std::string>> rows{{"node", "type", "frames", "cached", "why it runs"}};
    for (const auto& line : forecast.lines) {
        auto why = line.why;
        if (line.consumed_digests > 0)
            why += fmt::format("; takes {} of {} frames from the work folder",
                               line.consumed_digests, line.gathered);
        rows.push_back(
            {line.node, line.type, std::to_string(line.frames), std::to_string(line.cached), why});
    }
    out += text_table(rows) + "\n";
    if (std::ranges::all_of(forecast.lines, [](const auto& line) { return line.why.empty(); }))
        return out + "nothing to do: every result is there\n";
    for (std::size_t n = 0; n < forecast.passes.size(); ++n) {
        const auto& pass = forecast.passes[n];
        out += fmt::format(
            "pass {} of {}: {}{}{}{}\n", n + 1, forecast.passes.size(),
            counted(pass.frames, "frame"),
            pass.nodes.empty() ? "" : fmt::format(" through {}", fmt::join(pass.nodes, ", ")),
            pass.gathering.empty() ? "" : "; gathers ", fmt::join(pass.gathering, ", "));
    }
    out += "time: " + time_text(forecast);
    out +=
        forecast.bytes > 0 ? fmt::format("\nmemory: about {}\n", size_text(forecast.bytes)) : "\n";
    return out;
}

Json to_json(const Forecast& forecast) {
    Json out{{"pipeline", forecast.pipeline}, {"frames", forecast.delivered.frames()},
             {"nodes", Json::object()},       {"passes", Json::array()},
             {"seconds", forecast.seconds},   {"unmeasured", forecast.unmeasured},
             {"bytes", forecast.bytes},       {"disk", forecast.disk},
             {"cores", forecast.cores}};
    for (const auto& line : forecast.lines) {
        auto& node = out["nodes"][line.node];
        node = {{"type", line.type}, {"frames", line.frames}, {"cached", line.cached}};
        if (line.gathered > 0)
            node["taken"] = {{"frames", line.gathered}, {"cached", line.consumed_digests}};
        if (!line.why.empty()) node["why"] = line.why;
        if (!line.item.empty()) node["item"] = line.item;
    }
    for (const auto& pass : forecast.passes)
        out["passes"].push_back(
            {{"frames", pass.frames}, {"nodes", pass.nodes}, {"gathers", pass.gathering}});
    return out;
}

}  // namespace fluidcarve
