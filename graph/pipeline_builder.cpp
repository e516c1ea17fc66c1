#include "graph/pipeline_builder.h"

#include "carve/base/words.h"
#include "graph/frames_of_inputs.h"
#include "graph/infer_timelines.h"
#include "graph/old_files.h"
#include "graph/outlooks.h"
#include "graph/promises.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace fluidcarve {

namespace {

std::vector<std::size_t> nodes_read_by(const Node& node) {
    std::vector<std::size_t> out;
    for (const auto& link : node.links()) out.push_back(link.node);
    return out;
}

/// Whether a node reads a file for each frame.
bool reads_frames(const Node& node) {
    return node.params && std::ranges::any_of(node.type->params, [&](const ParamSpec& param) {
               return param.reads_file() && param.path(node.params.get()).per_frame();
           });
}

}  // namespace

Pipeline PipelineBuilder::build() {
    Pipeline out;
    out.name = document_.name;
    for (const auto& source : document_.sources) out.files.push_back(source.source->name);
    if (document_.provenance.kind != Value::Kind::null) {
        ValueReader reader(problems_, "'provenance'", any_number());
        out.provenance = ParamTraits<bool>::parse(document_.provenance, reader).value_or(true);
    }
    nodes_.reserve(document_.nodes.fields.size());
    for (const auto& field : document_.nodes.fields) read_node(field);
    out.frames = read_frames();
    for (auto& unfinished : nodes_) connect(unfinished);
    if (!order()) return out;
    std::vector<Node*> nodes;
    for (auto& unfinished : nodes_) nodes.push_back(&unfinished.node);
    pass_promises(nodes, problems_);
    infer_rates();
    if (document_.frames.text == "auto") out.holes = holes_in(out.frames);
    out.frames = infer_timelines(nodes, out.frames, problems_);
    check_paths(out.frames);
    check_written(out.frames);
    if (const auto note = staggered_note(document_.frames.text); !note.empty())
        out.notes.push_back("frames: " + note);
    out.notes.insert(out.notes.end(), notes_.begin(), notes_.end());
    check_confinement(out.frames);
    for (auto& unfinished : nodes_) out.nodes.push_back(std::move(unfinished.node));
    note_old_files(out);
    if (problems_.empty()) add_foreseen(out);
    return out;
}

FrameSet PipelineBuilder::read_frames() {
    if (document_.frames.kind == Value::Kind::null ||
        document_.frames.kind == Value::Kind::unresolved)
        return FrameSet({1});
    if (document_.frames.kind == Value::Kind::scalar && document_.frames.text == "auto")
        return auto_frames();
    std::string fault = "must be a frame set such as 1001-1084, not " + document_.frames.describe();
    if (document_.frames.kind == Value::Kind::scalar)
        if (auto frames = FrameSet::parse(document_.frames.text, fault)) return *frames;
    add(problems_, document_.frames.mark, "frames: " + fault);
    return FrameSet({1});
}

FrameSet PipelineBuilder::auto_frames() {
    std::vector<FramedInput> inputs;
    for (const auto& unfinished : nodes_) {
        if (!unfinished.node.params) return FrameSet({1});
        for (const auto& spec : unfinished.node.type->params)
            if (spec.reads_file())
                if (const auto& path = spec.path(unfinished.node.params.get()); path.per_frame())
                    inputs.push_back({unfinished.node.name, path,
                                      unfinished.value->find(spec.name)->value.mark});
    }
    const auto out =
        frames_of_inputs(inputs, document_.frames.mark, problems_).value_or(FrameSet({1}));
    for (const auto& input : inputs)
        if (auto note = note_on_odd_frames(input.path); !note.empty())
            notes_.push_back(std::move(note));
    return out;
}

void PipelineBuilder::add_foreseen(const Pipeline& pipeline) {
    const std::vector<bool> all(pipeline.nodes.size(), true);
    for (const auto& [n, message] : foresee(pipeline, all, {}).faults)
        add(problems_, pipeline.nodes[n].mark,
            fmt::format("{} {}", pipeline.nodes[n].type->name, message));
}

void PipelineBuilder::connect(UnfinishedNode& unfinished) {
    for (std::size_t n = 0; n < unfinished.references.size(); ++n)
        for (const auto& reference : unfinished.references[n])
            if (const auto link = resolve(reference, unfinished, n))
                unfinished.node.inputs[n].push_back(*link);
}

std::optional<Link> PipelineBuilder::resolve(const Reference& reference,
                                             const UnfinishedNode& unfinished, std::size_t input) {
    const auto source = index_.find(reference.node);
    if (source == index_.end()) {
        if (!known_.contains(reference.node))
            add(problems_, reference.mark,
                fmt::format("there is no node '{}'{}", reference.node,
                            did_you_mean(reference.node, {known_.begin(), known_.end()})));
        return std::nullopt;
    }
    const auto& from = nodes_[source->second].node;
    std::vector<std::string> ports;
    for (const auto& output : from.outputs) ports.push_back(output.name);
    if (ports.empty())
        return add(problems_, reference.mark,
                   fmt::format("'{}' ({}) has no output", from.name, from.type->name), from.mark,
                   "it is defined here"),
               std::nullopt;
    const auto found =
        reference.port.empty() ? ports.begin() : std::ranges::find(ports, reference.port);
    const auto& spec = unfinished.node.type->inputs[input];
    if (found == ports.end() && from.type->outputs_param.empty() &&
        registry_.selection(from.outputs.front().type, spec.type))
        return Link{source->second, 0, reference.port};
    if (found == ports.end()) {
        if (from.params || from.type->outputs_param.empty())
            add(problems_, reference.mark,
                fmt::format("'{}' ({}) has no output '{}'{}", from.name, from.type->name,
                            reference.port, did_you_mean(reference.port, ports)),
                from.mark, "it is defined here");
        return std::nullopt;
    }
    const Link link{source->second, static_cast<std::size_t>(found - ports.begin())};
    const auto& output = from.outputs[link.output];
    if (!registry_.accepts(spec.type, output.type)) {
        add(problems_, reference.mark,
            fmt::format("{} input '{}' takes {}, but {}.{} is {}", unfinished.node.type->name,
                        spec.name, registry_.accepted_names(*unfinished.node.type, spec), from.name,
                        output.name, registry_.payload(output.type).name),
            from.mark, fmt::format("'{}' ({}) is defined here", from.name, from.type->name));
        return std::nullopt;
    }
    return link;
}

bool PipelineBuilder::order() {
    enum class State { fresh, open, done };
    std::vector<State> state(nodes_.size(), State::fresh);
    // The open nodes, each with the nodes that it reads and that are still to be visited. A list,
    // since pipelines may be deeper than the program's stack.
    std::vector<std::pair<std::size_t, std::vector<std::size_t>>> path;
    std::vector<std::size_t> sorted;
    bool acyclic = true;
    const auto open = [&](std::size_t n) {
        state[n] = State::open;
        path.emplace_back(n, nodes_read_by(nodes_[n].node));
        std::ranges::reverse(path.back().second);
    };
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
        if (state[n] == State::fresh) open(n);
        while (!path.empty()) {
            auto& [node, left] = path.back();
            if (left.empty()) {
                state[node] = State::done;
                sorted.push_back(node);
                path.pop_back();
                continue;
            }
            const auto next = left.back();
            left.pop_back();
            if (state[next] == State::fresh) open(next);
            else if (state[next] == State::open) {
                acyclic = false;
                std::vector<std::size_t> nodes;
                for (const auto& each : path) nodes.push_back(each.first);
                report_cycle({std::ranges::find(nodes, next), nodes.end()});
            }
        }
    }
    if (!acyclic) return false;

    std::vector<std::size_t> now_at(nodes_.size());
    for (std::size_t n = 0; n < sorted.size(); ++n) now_at[sorted[n]] = n;
    std::vector<UnfinishedNode> reordered;
    for (const auto n : sorted) reordered.push_back(std::move(nodes_[n]));
    for (auto& unfinished : reordered)
        for (auto& links : unfinished.node.inputs)
            for (auto& link : links) link.node = now_at[link.node];
    nodes_ = std::move(reordered);
    return true;
}

void PipelineBuilder::report_cycle(std::vector<std::size_t> nodes) {
    std::ranges::reverse(nodes);
    const auto first = std::ranges::min_element(nodes);
    std::rotate(nodes.begin(), first, nodes.end());
    std::string text;
    for (const auto n : nodes) text += nodes_[n].node.name + " -> ";
    add(problems_, nodes_[nodes.front()].node.mark,
        fmt::format("these nodes feed each other in a cycle: {}{}", text,
                    nodes_[nodes.front()].node.name));
}

void PipelineBuilder::infer_rates() {
    for (auto& [node, value, references, unsure] : nodes_) {
        auto inputs = Rate::fixed;
        bool inputs_differ = false;  // from frame to frame, except those that are summed
        unsure = !node.params;
        for (std::size_t n = 0; n < references.size(); ++n)
            unsure = unsure || references[n].size() != node.inputs[n].size();
        for (std::size_t n = 0; n < node.inputs.size(); ++n)
            for (const auto& link : node.inputs[n]) {
                const auto rate = nodes_[link.node].node.rate;
                unsure = unsure || nodes_[link.node].unsure;
                node.per_frame_input = node.per_frame_input || rate == Rate::frame;
                inputs_differ =
                    inputs_differ || (rate == Rate::frame && !node.type->inputs[n].summed);
                inputs = std::max(inputs, rate);
            }
        if (node.params && node.type->traits) node.traits = node.type->traits(node.params.get());
        node.gathers = node.params && node.type->gathers && node.traits.gathers;
        const bool reads = reads_frames(node);
        bool from_sequence = reads;
        for (const auto& link : node.links())
            from_sequence = from_sequence || sequences_.contains(nodes_[link.node].node.name);
        if (from_sequence) sequences_.insert(node.name);

        const auto& animates = node.traits.animates;
        // A node that gathers can only tell frames apart by its inputs.
        const bool moves = reads || (animates == true && (!node.gathers || node.per_frame_input));
        const bool one_result = !node.type->per_frame_outputs ||
                                (node.gathers && (!inputs_differ || animates == false));
        if (moves) node.rate = Rate::frame;
        else if (node.per_frame_input && one_result) node.rate = Rate::sequence;
        else node.rate = inputs;
    }
}

}  // namespace fluidcarve
