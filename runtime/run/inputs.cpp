#include "runtime/run/inputs.h"

#include "carve/base/frame_set.h"
#include "runtime/run/carried_facts.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace fluidcarve {
namespace {

/// Collects what one node states about its files, or about its future inputs.
class SurveyOf : public Survey {
public:
    /// What other nodes take of the node.
    struct Taken {
        std::set<std::string, std::less<>> outputs;
        std::vector<Pick> picks;
    };
    /// @param needed  frames that the run will read; nothing: all
    SurveyOf(std::size_t node, const std::vector<int>& frames,
             const std::optional<FrameSet>& needed, CarriedFacts& facts, Taken taken = {})
        : node_(node), frames_(frames), needed_(needed), taken_(std::move(taken)), facts_(facts) {}
    const std::vector<int>& frames() const override { return frames_; }
    bool needs(int frame) const override { return !needed_ || needed_->contains(frame); }
    bool wants(std::string_view output) const override { return taken_.outputs.contains(output); }
    const std::vector<Pick>& picks() const override { return taken_.picks; }
    void stands_in(int frame, int file) override { stand_ins[frame] = file; }
    void expect(int, std::uint64_t bytes) override { most_bytes = std::max(most_bytes, bytes); }
    void leave_out(int frame) override { left_out.insert(frame); }
    void missing(int frame, const std::string& message) override {
        lost.emplace_back(frame, message);
    }
    void lies(std::string_view output, const Region& region) override {
        regions.emplace(output, region);
    }
    void warn(const std::string& message) override { warnings.push_back(message); }
    void delivers(int frame, std::string_view output, SurveyedFacts what) override {
        facts_.deliver(node_, frame, output, std::move(what));
    }
    const SurveyedFacts* receives(int frame, std::string_view input) const override {
        return facts_.receives(node_, frame, input);
    }

    std::map<int, int> stand_ins;
    std::uint64_t most_bytes = 0;
    std::set<int> left_out;
    std::vector<std::pair<int, std::string>> lost;
    std::map<std::string, Region> regions;
    std::vector<std::string> warnings;

private:
    std::size_t node_;
    const std::vector<int>& frames_;
    const std::optional<FrameSet>& needed_;
    const Taken taken_;
    CarriedFacts& facts_;
};

using OutputNames = std::set<std::string, std::less<>>;

/// Per node: names of its outputs that the run reads or caches.
std::vector<OutputNames> wanted_outputs(const Pipeline& pipeline, const std::vector<bool>& needed,
                                        bool cache) {
    std::vector<OutputNames> out(pipeline.nodes.size());
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        const auto& node = pipeline.nodes[n];
        if (cache && node.kept)
            for (const auto& output : node.outputs) out[n].insert(output.name);
        if (!needed[n]) continue;
        for (const auto& link : node.links())
            out[link.node].insert(pipeline.nodes[link.node].outputs[link.output].name);
    }
    return out;
}

/// The frames of a node that the run needs; nothing: all.
std::optional<FrameSet> frames_needed(const Pipeline& pipeline, const Plan& plan, std::size_t n,
                                      const std::optional<FrameSet>& deliver) {
    const auto& node = pipeline.nodes[n];
    return node.rate == Rate::frame && !node.gathers && !plan.in_sequence[n] ? deliver
                                                                             : std::nullopt;
}

/// Adds the failures of missing files that a survey found.
void add_missing(const Node& node, const SurveyOf& of, std::vector<NodeFailure>& out) {
    for (const auto& [frame, message] : of.lost)
        if (of.needs(frame))
            out.push_back(failure_in(node,
                                     node.rate == Rate::fixed ? std::nullopt : std::optional(frame),
                                     message, Failure::Kind::input));
}

/// Passes the facts of readers through the pipeline, and lets the other nodes check them.
void look_ahead(const Pipeline& pipeline, const Plan& plan, const std::optional<FrameSet>& deliver,
                CarriedFacts& facts, Inputs& out) {
    if (out.timelines.frames().empty()) return;
    const std::vector<int> once{out.timelines.frames().front()};
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        const auto& node = pipeline.nodes[n];
        if (!plan.needed[n] || node.type->inputs.empty()) continue;
        const auto& frames = node.per_frame_input || node.rate == Rate::frame
                                 ? out.timelines.input_frames(n).frames
                                 : once;
        const auto needed = frames_needed(pipeline, plan, n, deliver);
        for (const int frame : frames) {
            if (needed && !needed->contains(frame)) continue;
            const auto clash = facts.carry(n, frame);
            if (clash.empty()) continue;
            out.clashes.push_back(
                failure_in(node, node.rate == Rate::fixed ? std::nullopt : std::optional(frame),
                           clash, Failure::Kind::input));
            break;
        }
        if (!node.type->survey) continue;
        SurveyOf of(n, frames, needed, facts);
        node.type->survey(node.params.get(), of);
        add_missing(node, of, out.missing);
    }
}

/// The node whose first output has the parts of a link's payload, by name: follows nodes whose
/// volumes have the grids of an input (Declare::names_from) upstream. Nothing if it arrives at an
/// output that is only a part itself.
std::optional<std::size_t> source_of(const Pipeline& pipeline, Link link) {
    while (link.output == 0) {
        const auto& node = pipeline.nodes[link.node];
        const auto* const named = node.type->input(node.type->names_from);
        if (!named) return link.node;
        const auto input = static_cast<std::size_t>(named - node.type->inputs.data());
        if (node.inputs[input].empty() || !node.inputs[input].front().part.empty()) break;
        link = node.inputs[input].front();
    }
    return std::nullopt;
}

/// Per node: the parts of its first output that nodes of the run take, directly or from nodes that
/// pass these on.
std::vector<std::vector<Pick>> picks_of(const Pipeline& pipeline, const std::vector<bool>& needed) {
    std::vector<std::vector<Pick>> out(pipeline.nodes.size());
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        const auto& node = pipeline.nodes[n];
        for (std::size_t input = 0; needed[n] && input < node.inputs.size(); ++input)
            for (const auto& link : node.inputs[input]) {
                if (link.part.empty()) continue;
                if (const auto source = source_of(pipeline, link))
                    out[*source].push_back(
                        {link.part, node.type->inputs[input].type,
                         fmt::format("'{}' takes {}.{}", node.name, pipeline.nodes[link.node].name,
                                     link.part)});
            }
    }
    return out;
}

}  // namespace

Inputs survey_inputs(const Pipeline& pipeline, const Plan& plan,
                     const std::optional<FrameSet>& deliver, bool cache, Report& report) {
    Inputs out;
    std::set<int> left_out;
    CarriedFacts facts(pipeline);
    const auto wanted = wanted_outputs(pipeline, plan.needed, cache);
    const auto picks = picks_of(pipeline, plan.needed);
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        const auto& node = pipeline.nodes[n];
        if (!plan.needed[n] || !node.type->survey || !node.type->inputs.empty()) continue;
        const std::vector<int> once{pipeline.frames.frames().front()};
        const auto read = frames_needed(pipeline, plan, n, deliver);
        SurveyOf of(n, node.rate == Rate::fixed ? once : node.frames.frames(), read, facts,
                    {wanted[n], picks[n]});
        node.type->survey(node.params.get(), of);
        for (const auto& warning : of.warnings) report.warn(n, warning);
        out.stand_ins[n] = of.stand_ins;
        out.regions[n] = of.regions;
        out.frame_bytes = std::max(out.frame_bytes, of.most_bytes);
        add_missing(node, of, out.missing);
        std::vector<int> asked;
        for (const auto frame : of.left_out)
            if (deliver && deliver->contains(frame)) asked.push_back(frame);
        if (!asked.empty())
            report.warn(
                n, fmt::format("left out because their files are missing, though -f names them: {}",
                               FrameSet(asked).text()));
        left_out.insert(of.left_out.begin(), of.left_out.end());
    }
    out.timelines = Timelines(pipeline, left_out);
    // With frames left out, the nearest file of a frame may be another one: find the stand-ins
    // again.
    for (auto& [n, stand_ins] : out.stand_ins) {
        if (stand_ins.empty() || left_out.empty() || pipeline.nodes[n].rate == Rate::fixed)
            continue;
        const std::optional<FrameSet> none = FrameSet();
        SurveyOf again(n, out.timelines.delivered(n).frames, none, facts);
        pipeline.nodes[n].type->survey(pipeline.nodes[n].params.get(), again);
        stand_ins = again.stand_ins;
    }
    look_ahead(pipeline, plan, deliver, facts, out);
    return out;
}

}  // namespace fluidcarve
