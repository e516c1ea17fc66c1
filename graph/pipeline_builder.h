#pragma once

#include "carve/base/frame_set.h"
#include "carve/base/words.h"
#include "formats/file/confinement.h"
#include "graph/code_trust.h"
#include "graph/document.h"
#include "graph/field_names.h"
#include "graph/file_claims.h"
#include "graph/frames_of_inputs.h"
#include "graph/node_kinds.h"
#include "graph/outlooks.h"
#include "graph/pipeline.h"
#include "graph/promises.h"
#include "graph/timelines.h"
#include "graph/types/frame_files.h"
#include "graph/types/registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

namespace fluidcarve {

/// One connection as written: `node` or `node.port`.
struct Reference {
    Mark mark;
    std::string node;
    std::string port;  ///< empty: the main output
};

/// A node during the checks.
struct NodeDraft {
    Node node;
    const Value* value = nullptr;                    ///< the node's map in the document
    std::vector<std::vector<Reference>> references;  ///< `[input][connection]`
    bool unsure = false;  ///< the rate is unknown because of a problem here or upstream
};

/// The NodeCheck of one draft; faults become problems.
class NodeCheckOf : public NodeCheck {
public:
    NodeCheckOf(NodeDraft& draft, Problems& problems) : draft_(draft), problems_(problems) {}
    bool stated(std::string_view field) const override {
        return draft_.value->find(field) != nullptr;
    }
    std::size_t connections(std::string_view input) const override {
        for (std::size_t n = 0; n < draft_.references.size(); ++n)
            if (draft_.node.type->inputs[n].name == input) return draft_.references[n].size();
        return 0;
    }
    void fault(std::string_view field, const std::string& message) override {
        fault(place(field), message);
    }
    void fault(const Mark& at, const std::string& message) override {
        add(problems_, at, fmt::format("{} {}", draft_.node.type->name, message));
    }
    void warn(std::string_view field, const std::string& message) override {
        add(draft_.node.warnings, place(field), message);
    }
    std::vector<std::string> names(std::string_view input) const override {
        for (std::size_t n = 0; n < draft_.node.input_names.size(); ++n)
            if (draft_.node.type->inputs[n].name == input) return draft_.node.input_names[n];
        return {};
    }

private:
    const Mark& place(std::string_view field) const {
        const auto* const found = draft_.value->find(field);
        return found ? found->value.mark : draft_.node.mark;
    }

    NodeDraft& draft_;
    Problems& problems_;
};

/// Builds a pipeline from a document, step by step.
class PipelineBuilder {
public:
    PipelineBuilder(const Document& document, const Registry& registry, Problems& problems)
        : document_(document), registry_(registry), problems_(problems) {}

    Pipeline build() {
        Pipeline out;
        out.name = document_.name;
        for (const auto& source : document_.sources) out.files.push_back(source.source->name);
        if (document_.provenance.kind != Value::Kind::null) {
            ValueReader reader(problems_, "'provenance'", any_number());
            out.provenance = ParamTraits<bool>::parse(document_.provenance, reader).value_or(true);
        }
        drafts_.reserve(document_.nodes.fields.size());
        for (const auto& field : document_.nodes.fields) read_node(field);
        out.frames = read_frames();
        for (auto& draft : drafts_) connect(draft);
        if (!order()) return out;
        std::vector<Node*> nodes;
        for (auto& draft : drafts_) nodes.push_back(&draft.node);
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
        for (auto& draft : drafts_) out.nodes.push_back(std::move(draft.node));
        note_old_files(out);
        if (problems_.empty()) add_foreseen(out);
        return out;
    }

private:
    FrameSet read_frames() {
        if (document_.frames.kind == Value::Kind::null ||
            document_.frames.kind == Value::Kind::unresolved)
            return FrameSet({1});
        if (document_.frames.kind == Value::Kind::scalar && document_.frames.text == "auto")
            return auto_frames();
        std::string fault =
            "must be a frame set such as 1001-1084, not " + document_.frames.describe();
        if (document_.frames.kind == Value::Kind::scalar)
            if (auto frames = FrameSet::parse(document_.frames.text, fault)) return *frames;
        add(problems_, document_.frames.mark, "frames: " + fault);
        return FrameSet({1});
    }

    FrameSet auto_frames() {
        std::vector<FramedInput> inputs;
        for (const auto& draft : drafts_) {
            if (!draft.node.params) return FrameSet({1});
            for (const auto& spec : draft.node.type->params)
                if (spec.shape.kind == Shape::Kind::input_path)
                    if (const auto& path = spec.path(draft.node.params.get()); path.per_frame())
                        inputs.push_back(
                            {draft.node.name, path, draft.value->find(spec.name)->value.mark});
        }
        const auto out =
            frames_of_inputs(inputs, document_.frames.mark, problems_).value_or(FrameSet({1}));
        for (const auto& input : inputs)
            if (auto note = note_on_odd_frames(input.path); !note.empty())
                notes_.push_back(std::move(note));
        return out;
    }

    void read_node(const Value::Field& field) {
        const auto& [name, mark, value] = field;
        const auto letter = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; };
        if (name.empty() || !std::all_of(name.begin(), name.end(), letter))
            return add(problems_, mark,
                       fmt::format("'{}' can't name a node; use letters, digits, _ and -", name));
        known_.insert(name);
        if (value.kind != Value::Kind::map)
            return add(problems_, value.mark,
                       fmt::format("node '{}' must be {{type: ..., ...}}, not {}", name,
                                   value.describe()));
        const auto* const type = value.find("type");
        if (!type) return add(problems_, mark, fmt::format("node '{}' has no type", name));
        const auto* const node_type = type_of(value, document_, registry_);
        if (!node_type)
            return add(problems_, type->value.mark,
                       fmt::format("there is no node type {}{}", type->value.describe(),
                                   near_type(type->value.text)));

        NodeDraft draft;
        draft.value = &value;
        draft.node.name = name;
        draft.node.mark = mark;
        draft.node.type = node_type;
        draft.references.resize(node_type->inputs.size());
        draft.node.inputs.resize(node_type->inputs.size());
        draft.node.input_names.resize(node_type->inputs.size());
        check_field_names(value, type->value.mark, *node_type, document_.sources, problems_);
        read_params(draft);
        read_cache(draft);
        for (std::size_t n = 0; n < node_type->inputs.size(); ++n) read_references(draft, n);
        if (node_type->runs_code && !code_allowed())
            add(problems_, type->value.mark,
                fmt::format("{} runs code that the pipeline names, with your rights, and nobody "
                            "allowed that; if you trust it, give --allow-plugins",
                            node_type->name));
        else if (node_type->check && draft.node.params) {
            NodeCheckOf check(draft, problems_);
            node_type->check(draft.node.params.get(), check);
        }
        index_[name] = drafts_.size();
        drafts_.push_back(std::move(draft));
    }

    /// Suggests the nearest type, else the types of the family, else the command that lists all
    /// types.
    std::string near_type(const std::string& name) const {
        const auto all = registry_.node_names();
        if (const auto best = nearest(name, all); !best.empty())
            return fmt::format("; did you mean '{}'?", best);
        std::vector<std::string> family;
        for (const auto& each : all)
            if (each.starts_with(name.substr(0, name.find('.')) + ".")) family.push_back(each);
        return family.empty() ? std::string("; `fluidcarve nodes` lists them")
                              : fmt::format("; known: {}", fmt::join(family, ", "));
    }

    void read_params(NodeDraft& draft) {
        const auto& type = *draft.node.type;
        const auto params = type.make_params();
        bool good = true;
        for (const auto& spec : type.params) {
            const auto* const field = draft.value->find(spec.name);
            if (!field && spec.required) {
                add(problems_, draft.node.mark,
                    fmt::format("{} needs '{}': {}", type.name, spec.name, to_text(spec.shape)));
                good = false;
            }
            if (!field || field->value.kind == Value::Kind::null) continue;
            ValueReader reader(problems_, fmt::format("{} parameter '{}'", type.name, spec.name),
                               spec.range);
            good = spec.parse(params.get(), field->value, reader) && good;
        }
        draft.node.outputs = type.outputs;
        if (!good) return;
        draft.node.params = params;
        if (type.named_outputs)
            for (auto& output : type.named_outputs(params.get()))
                draft.node.outputs.push_back(std::move(output));
    }

    /// Adds the faults that nodes foresee as problems.
    void add_foreseen(const Pipeline& pipeline) {
        const std::vector<bool> all(pipeline.nodes.size(), true);
        for (const auto& [n, message] : foresee(pipeline, all, {}).faults)
            add(problems_, pipeline.nodes[n].mark,
                fmt::format("{} {}", pipeline.nodes[n].type->name, message));
    }

    /// Decides whether results are cached: the node's `cache` field, else the type.
    void read_cache(NodeDraft& draft) {
        const auto& type = *draft.node.type;
        draft.node.kept = type.kept || draft.node.outputs.empty();
        draft.node.digests_kept = true;
        const auto* const field = draft.value->find("cache");
        if (!field || field->value.kind == Value::Kind::null) return;
        ValueReader reader(problems_, fmt::format("{} field 'cache'", type.name), any_number());
        const auto wanted = ParamTraits<bool>::parse(field->value, reader);
        if (!wanted) return;
        draft.node.kept = draft.node.digests_kept = *wanted;
        for (const auto& output : draft.node.outputs)
            if (const auto& payload = registry_.payload(output.type); *wanted && !payload.write)
                return add(
                    problems_, field->value.mark,
                    fmt::format(
                        "{} can't be kept: its output '{}' is {}, which can't be written to a file",
                        type.name, output.name, payload.name));
    }

    void read_references(NodeDraft& draft, std::size_t n) {
        const auto& spec = draft.node.type->inputs[n];
        const auto* const field = draft.value->find(spec.name);
        if (!field) {
            if (!spec.optional)
                add(problems_, draft.node.mark,
                    fmt::format("{} needs its input '{}' ({})", draft.node.type->name, spec.name,
                                registry_.accepted_names(*draft.node.type, spec)));
            return;
        }
        const auto take = [&](const Value& value, const std::string& name) {
            if (value.kind == Value::Kind::unresolved) return;
            if (value.kind != Value::Kind::scalar)
                return add(problems_, value.mark,
                           fmt::format("{} input '{}' must be a node or node.output, not {}",
                                       draft.node.type->name, spec.name, value.describe()));
            const auto dot = value.text.find('.');
            draft.references[n].push_back(
                {value.mark, value.text.substr(0, dot),
                 dot == std::string::npos ? std::string() : value.text.substr(dot + 1)});
            draft.node.input_names[n].push_back(name);
        };
        const auto& value = field->value;
        if (value.kind == Value::Kind::null) return;
        if (spec.arity == InputSpec::Arity::list && value.kind == Value::Kind::list) {
            if (value.items.empty())
                add(problems_, value.mark,
                    fmt::format("{} input '{}' is an empty list", draft.node.type->name,
                                spec.name));
            for (const auto& item : value.items) take(item, {});
        } else if (spec.arity == InputSpec::Arity::named) {
            if (value.kind != Value::Kind::map)
                add(problems_, value.mark,
                    fmt::format("{} input '{}' must be {{name: node.output, ...}}, not {}",
                                draft.node.type->name, spec.name, value.describe()));
            for (const auto& each : value.fields) take(each.value, each.name);
        } else {
            take(value, {});
        }
    }

    void connect(NodeDraft& draft) {
        for (std::size_t n = 0; n < draft.references.size(); ++n)
            for (const auto& reference : draft.references[n])
                if (const auto link = resolve(reference, draft, n))
                    draft.node.inputs[n].push_back(*link);
    }

    std::optional<Link> resolve(const Reference& reference, const NodeDraft& draft,
                                std::size_t input) {
        const auto source = index_.find(reference.node);
        if (source == index_.end()) {
            if (!known_.contains(reference.node))
                add(problems_, reference.mark,
                    fmt::format("there is no node '{}'{}", reference.node,
                                did_you_mean(reference.node, {known_.begin(), known_.end()})));
            return std::nullopt;
        }
        const auto& from = drafts_[source->second].node;
        std::vector<std::string> ports;
        for (const auto& output : from.outputs) ports.push_back(output.name);
        if (ports.empty())
            return add(problems_, reference.mark,
                       fmt::format("'{}' ({}) has no output", from.name, from.type->name),
                       from.mark, "it is defined here"),
                   std::nullopt;
        const auto found = reference.port.empty()
                               ? ports.begin()
                               : std::find(ports.begin(), ports.end(), reference.port);
        const auto& spec = draft.node.type->inputs[input];
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
                fmt::format("{} input '{}' takes {}, but {}.{} is {}", draft.node.type->name,
                            spec.name, registry_.accepted_names(*draft.node.type, spec), from.name,
                            output.name, registry_.payload(output.type).name),
                from.mark, fmt::format("'{}' ({}) is defined here", from.name, from.type->name));
            return std::nullopt;
        }
        return link;
    }

    /// Sorts the drafts so that each comes after its inputs. If there is a cycle, adds a problem
    /// and returns false.
    bool order() {
        enum class State { fresh, open, done };
        std::vector<State> state(drafts_.size(), State::fresh);
        std::vector<std::size_t> path;
        std::vector<std::size_t> sorted;
        bool acyclic = true;
        const auto visit = [&](auto&& self, std::size_t n) -> void {
            state[n] = State::open;
            path.push_back(n);
            for (const auto& links : drafts_[n].node.inputs)
                for (const auto& link : links) {
                    if (state[link.node] == State::fresh) self(self, link.node);
                    else if (state[link.node] == State::open) {
                        acyclic = false;
                        report_cycle({std::find(path.begin(), path.end(), link.node), path.end()});
                    }
                }
            path.pop_back();
            state[n] = State::done;
            sorted.push_back(n);
        };
        for (std::size_t n = 0; n < drafts_.size(); ++n)
            if (state[n] == State::fresh) visit(visit, n);
        if (!acyclic) return false;

        std::vector<std::size_t> now_at(drafts_.size());
        for (std::size_t n = 0; n < sorted.size(); ++n) now_at[sorted[n]] = n;
        std::vector<NodeDraft> reordered;
        for (const auto n : sorted) reordered.push_back(std::move(drafts_[n]));
        for (auto& draft : reordered)
            for (auto& links : draft.node.inputs)
                for (auto& link : links) link.node = now_at[link.node];
        drafts_ = std::move(reordered);
        return true;
    }

    /// @param nodes  each reads the next; the last reads the first
    void report_cycle(std::vector<std::size_t> nodes) {
        std::reverse(nodes.begin(), nodes.end());
        const auto first = std::min_element(nodes.begin(), nodes.end());
        std::rotate(nodes.begin(), first, nodes.end());
        std::string text;
        for (const auto n : nodes) text += drafts_[n].node.name + " -> ";
        add(problems_, drafts_[nodes.front()].node.mark,
            fmt::format("these nodes feed each other in a cycle: {}{}", text,
                        drafts_[nodes.front()].node.name));
    }

    void infer_rates() {
        for (auto& [node, value, references, unsure] : drafts_) {
            auto inputs = Rate::fixed;
            bool differ = false;  // inputs from frame to frame, and outputs by them
            unsure = !node.params;
            for (std::size_t n = 0; n < references.size(); ++n)
                unsure = unsure || references[n].size() != node.inputs[n].size();
            for (std::size_t n = 0; n < node.inputs.size(); ++n)
                for (const auto& link : node.inputs[n]) {
                    const auto rate = drafts_[link.node].node.rate;
                    unsure = unsure || drafts_[link.node].unsure;
                    node.per_frame_input = node.per_frame_input || rate == Rate::frame;
                    differ = differ || (rate == Rate::frame && !node.type->inputs[n].summed);
                    inputs = std::max(inputs, rate);
                }
            node.gathers = node.params && node.type->gathers(node.params.get());
            const bool animates =
                node.params && node.type->animates && node.type->animates(node.params.get());
            // A node that gathers can only tell frames apart by its inputs.
            bool reads = false, moves = animates && (!node.gathers || node.per_frame_input);
            if (node.params)
                for (const auto& spec : node.type->params)
                    reads = reads || (spec.shape.kind == Shape::Kind::input_path &&
                                      spec.path(node.params.get()).per_frame());
            moves = moves || reads;
            for (const auto& links : node.inputs)
                for (const auto& link : links)
                    reads = reads || sequences_.contains(drafts_[link.node].node.name);
            if (reads) sequences_.insert(node.name);
            const bool once = !node.type->per_frame_outputs ||
                              (node.gathers && (!differ || (node.type->animates && !animates)));
            if (moves) node.rate = Rate::frame;
            else if (node.per_frame_input && once) node.rate = Rate::sequence;
            else node.rate = inputs;
        }
    }

    /// Checks the paths of writers. A writer that runs per frame needs a frame token, unless there
    /// is one frame and it reads no sequence; a writer that runs once can't have one. No file may
    /// be written twice or overwrite an input.
    void check_paths(const FrameSet& frames);

    /// If a reader upstream of a writer reads a sequence as one file, adds the problem there.
    /// @param mark  of the writer's path @return whether there is such a reader
    bool blame_reader(const Node& writer, const Mark& mark, const FrameSet& frames);

    /// Checks that other nodes write the files of each WrittenPath.
    void check_written(const FrameSet& frames);

    /// Checks that all files lie where the program may read and write.
    void check_confinement(const FrameSet& frames);

    const Document& document_;
    const Registry& registry_;
    Problems& problems_;
    std::vector<NodeDraft> drafts_;
    std::map<std::string, std::size_t> index_;  ///< name to index in `drafts_`
    /// All node names in the file, also of nodes with an unknown type.
    std::set<std::string> known_;
    /// Nodes that read a file per frame, and nodes downstream of them.
    std::set<std::string> sequences_;
    std::vector<std::string> notes_;  ///< Pipeline::notes
};

}  // namespace fluidcarve
