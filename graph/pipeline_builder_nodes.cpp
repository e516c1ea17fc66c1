#include "carve/base/words.h"
#include "graph/code_trust.h"
#include "graph/field_names.h"
#include "graph/node_kinds.h"
#include "graph/pipeline_builder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <utility>

// How a PipelineBuilder reads the nodes of a document, before it connects them.

namespace fluidcarve {

namespace {

/// The NodeCheck of one node; faults become problems.
class NodeCheckOf : public NodeCheck {
public:
    NodeCheckOf(UnfinishedNode& node, Problems& problems) : node_(node), problems_(problems) {}
    bool stated(std::string_view field) const override {
        return node_.value->find(field) != nullptr;
    }
    std::size_t connections(std::string_view input) const override {
        for (std::size_t n = 0; n < node_.references.size(); ++n)
            if (node_.node.type->inputs[n].name == input) return node_.references[n].size();
        return 0;
    }
    void fault(std::string_view field, const std::string& message) override {
        fault(place(field), message);
    }
    void fault(const Mark& at, const std::string& message) override {
        add(problems_, at, fmt::format("{} {}", node_.node.type->name, message));
    }
    void warn(std::string_view field, const std::string& message) override {
        add(node_.node.warnings, place(field), message);
    }
    std::vector<std::string> names(std::string_view input) const override {
        for (std::size_t n = 0; n < node_.node.input_names.size(); ++n)
            if (node_.node.type->inputs[n].name == input) return node_.node.input_names[n];
        return {};
    }

private:
    const Mark& place(std::string_view field) const {
        const auto* const found = node_.value->find(field);
        return found ? found->value.mark : node_.node.mark;
    }

    UnfinishedNode& node_;
    Problems& problems_;
};

}  // namespace

void PipelineBuilder::read_node(const Value::Field& field) {
    const auto& [name, mark, value] = field;
    const auto letter = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; };
    if (name.empty() || !std::ranges::all_of(name, letter))
        return add(problems_, mark,
                   fmt::format("'{}' can't name a node; use letters, digits, _ and -", name));
    known_.insert(name);
    if (value.kind != Value::Kind::map)
        return add(
            problems_, value.mark,
            fmt::format("node '{}' must be {{type: ..., ...}}, not {}", name, value.describe()));
    const auto* const type = value.find("type");
    if (!type) return add(problems_, mark, fmt::format("node '{}' has no type", name));
    const auto* const node_type = type_of(value, document_, registry_);
    if (!node_type)
        return add(problems_, type->value.mark,
                   fmt::format("there is no node type {}{}", type->value.describe(),
                               near_type(type->value.text)));

    UnfinishedNode unfinished;
    unfinished.value = &value;
    unfinished.node.name = name;
    unfinished.node.mark = mark;
    unfinished.node.type = node_type;
    unfinished.references.resize(node_type->inputs.size());
    unfinished.node.inputs.resize(node_type->inputs.size());
    unfinished.node.input_names.resize(node_type->inputs.size());
    check_field_names(value, type->value.mark, *node_type, document_.sources, problems_);
    read_params(unfinished);
    read_cache(unfinished);
    for (std::size_t n = 0; n < node_type->inputs.size(); ++n) read_references(unfinished, n);
    if (node_type->runs_code && !code_allowed())
        add(problems_, type->value.mark,
            fmt::format("{} runs code that the pipeline names, with your rights, and nobody "
                        "allowed that; if you trust it, give --allow-plugins",
                        node_type->name));
    else if (node_type->check && unfinished.node.params) {
        NodeCheckOf check(unfinished, problems_);
        node_type->check(unfinished.node.params.get(), check);
    }
    index_[name] = nodes_.size();
    nodes_.push_back(std::move(unfinished));
}

std::string PipelineBuilder::near_type(const std::string& name) const {
    const auto all = registry_.node_names();
    if (const auto best = nearest(name, all); !best.empty())
        return fmt::format("; did you mean '{}'?", best);
    std::vector<std::string> known;
    for (const auto& each : all)
        if (family_of(each) == family_of(name)) known.push_back(each);
    return known.empty() ? std::string("; `fluidcarve nodes` lists them")
                         : fmt::format("; known: {}", fmt::join(known, ", "));
}

void PipelineBuilder::read_params(UnfinishedNode& unfinished) {
    const auto& type = *unfinished.node.type;
    const auto params = type.make_params();
    bool good = true;
    for (const auto& spec : type.params) {
        const auto* const field = unfinished.value->find(spec.name);
        if (!field && spec.required) {
            add(problems_, unfinished.node.mark,
                fmt::format("{} needs '{}': {}", type.name, spec.name, to_text(spec.shape)));
            good = false;
        }
        if (!field || field->value.kind == Value::Kind::null) continue;
        ValueReader reader(problems_, fmt::format("{} parameter '{}'", type.name, spec.name),
                           spec.range);
        good = spec.parse(params.get(), field->value, reader) && good;
    }
    unfinished.node.outputs = type.outputs;
    if (!good) return;
    unfinished.node.params = params;
    if (type.named_outputs)
        for (auto& output : type.named_outputs(params.get()))
            unfinished.node.outputs.push_back(std::move(output));
}

void PipelineBuilder::read_cache(UnfinishedNode& unfinished) {
    const auto& type = *unfinished.node.type;
    unfinished.node.kept = type.kept || unfinished.node.outputs.empty();
    unfinished.node.digests_kept = true;
    const auto* const field = unfinished.value->find("cache");
    if (!field || field->value.kind == Value::Kind::null) return;
    ValueReader reader(problems_, fmt::format("{} field 'cache'", type.name), any_number());
    const auto wanted = ParamTraits<bool>::parse(field->value, reader);
    if (!wanted) return;
    unfinished.node.kept = unfinished.node.digests_kept = *wanted;
    for (const auto& output : unfinished.node.outputs)
        if (const auto& payload = registry_.payload(output.type); *wanted && !payload.write)
            return add(
                problems_, field->value.mark,
                fmt::format(
                    "{} can't be kept: its output '{}' is {}, which can't be written to a file",
                    type.name, output.name, payload.name));
}

void PipelineBuilder::read_references(UnfinishedNode& unfinished, std::size_t n) {
    const auto& spec = unfinished.node.type->inputs[n];
    const auto* const field = unfinished.value->find(spec.name);
    if (!field) {
        if (!spec.optional)
            add(problems_, unfinished.node.mark,
                fmt::format("{} needs its input '{}' ({})", unfinished.node.type->name, spec.name,
                            registry_.accepted_names(*unfinished.node.type, spec)));
        return;
    }
    const auto take = [&](const Value& value, const std::string& name) {
        if (value.kind == Value::Kind::unresolved) return;
        if (value.kind != Value::Kind::scalar)
            return add(problems_, value.mark,
                       fmt::format("{} input '{}' must be a node or node.output, not {}",
                                   unfinished.node.type->name, spec.name, value.describe()));
        const auto dot = value.text.find('.');
        unfinished.references[n].push_back(
            {value.mark, value.text.substr(0, dot),
             dot == std::string::npos ? std::string() : value.text.substr(dot + 1)});
        unfinished.node.input_names[n].push_back(name);
    };
    const auto& value = field->value;
    if (value.kind == Value::Kind::null) return;
    if (spec.arity == InputSpec::Arity::list && value.kind == Value::Kind::list) {
        if (value.items.empty())
            add(problems_, value.mark,
                fmt::format("{} input '{}' is an empty list", unfinished.node.type->name,
                            spec.name));
        for (const auto& item : value.items) take(item, {});
    } else if (spec.arity == InputSpec::Arity::named) {
        if (value.kind != Value::Kind::map)
            add(problems_, value.mark,
                fmt::format("{} input '{}' must be {{name: node.output, ...}}, not {}",
                            unfinished.node.type->name, spec.name, value.describe()));
        for (const auto& each : value.fields) take(each.value, each.name);
    } else {
        take(value, {});
    }
}

}  // namespace fluidcarve
