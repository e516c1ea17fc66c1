#include "graph/views/value_sources.h"

#include "carve/base/one_line.h"
#include "graph/node_kinds.h"
#include "graph/text/json_text.h"
#include "graph/text/yaml_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>
#include <set>

namespace fluidcarve {
namespace {

using Json = nlohmann::ordered_json;

/// Finds the sources of values in a document.
class Finder {
public:
    explicit Finder(const Document& document) : document_(document) {
        std::set<std::pair<Mark, std::string>> names_seen;  // an alias repeats what was inserted
        for (const auto& [in, name] : document.insertions)
            if (names_seen.emplace(in, name).second) inserted_[in].push_back(name);
    }

    ValueSource stated(const Value& value) const {
        ValueSource out{yaml_text(value), place(value.mark), {}};
        std::set<std::string> seen;
        add_names(value, out.with, seen);
        return out;
    }

    static ValueSource fallback(const std::string& yaml) {
        return {yaml.empty() ? yaml_scalar(yaml) : yaml, "default", {}};
    }

    ValueSources::Fields of_node(const NodeType& type, const Value& node) const {
        ValueSources::Fields out;
        const auto add = [&](const std::string& name) {
            const auto* const field = node.find(name);
            if (field) out.emplace_back(name, stated(field->value));
            return field != nullptr;
        };
        add("type");
        for (const auto& input : type.inputs) add(input.name);
        for (const auto& param : type.params)
            if (!add(param.name)) out.emplace_back(param.name, fallback(param.fallback));
        for (const auto& field : node.fields)
            if (field.name != "type" && !type.input(field.name) && !type.param(field.name))
                add(field.name);
        return out;
    }

private:
    std::string place(const Mark& mark) const {
        const auto is = [&](const Mark& file) { return file.source == mark.source; };
        const bool file = std::ranges::any_of(document_.sources, is);
        return file ? fmt::format("{}:{}", mark.source->name, mark.line) : mark.source->name;
    }

    /// Adds the names inserted into a value or its parts, without duplicates.
    void add_names(const Value& value, std::vector<std::string>& names,
                   std::set<std::string>& seen) const {
        if (const auto found = inserted_.find(value.mark); found != inserted_.end())
            for (const auto& name : found->second)
                if (seen.insert(name).second) names.push_back(name);
        for (const auto& item : value.items) add_names(item, names, seen);
        for (const auto& field : value.fields) add_names(field.value, names, seen);
    }

    const Document& document_;
    std::map<Mark, std::vector<std::string>> inserted_;  ///< names inserted at a place
};

std::string line(const std::string& name, const ValueSource& source) {
    const auto from = source.from == "default" ? source.from : "from " + source.from;
    const auto with =
        source.with.empty() ? std::string() : fmt::format(" with {}", fmt::join(source.with, ", "));
    return one_line(fmt::format("{} = {}, {}{}", name, source.value, from, with)) + "\n";
}

Json to_json(const ValueSource& source) {
    Json out{{"value", source.value}, {"from", source.from}};
    if (!source.with.empty()) out["with"] = source.with;
    return out;
}

Json to_json(const ValueSources::Fields& fields) {
    auto out = Json::object();
    for (const auto& [name, source] : fields) out[name] = to_json(source);
    return out;
}

}  // namespace

ValueSources value_sources_of(const Document& document, const Registry& registry) {
    const Finder find(document);
    ValueSources out;
    out.frames = document.frames.kind == Value::Kind::null ? Finder::fallback("1")
                                                           : find.stated(document.frames);
    for (const auto& param : document.params.fields)
        out.params.emplace_back(param.name, find.stated(param.value));
    for (const auto& node : document.nodes.fields)
        out.nodes.emplace_back(node.name,
                               find.of_node(*type_of(node.value, document, registry), node.value));
    return out;
}

std::string to_text(const ValueSources& sources) {
    auto out = line("frames", sources.frames);
    if (!sources.params.empty()) out += "\nparams:\n";
    for (const auto& [name, source] : sources.params) out += "  " + line(name, source);
    out += "\nnodes:\n";
    for (const auto& [node, fields] : sources.nodes) {
        out += "  " + node + ":\n";
        for (const auto& [name, source] : fields) out += "    " + line(name, source);
    }
    return sources.files.empty() ? out : out + "\n" + to_text(sources.files);
}

Json to_json(const ValueSources& sources) {
    Json out{{"frames", to_json(sources.frames)},
             {"params", to_json(sources.params)},
             {"nodes", Json::object()}};
    for (const auto& [node, fields] : sources.nodes) out["nodes"][node] = to_json(fields);
    for (const auto& file : sources.files) {
        auto& entry = out["files"][file.node + "." + file.field];
        entry = {{"path", file.path}, {"writes", file.writes}};
        if (!file.writes) entry["found"] = file.found;
    }
    return out;
}

}  // namespace fluidcarve
