#include "graph/views/describe.h"

#include "graph/text/json_text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace fluidcarve {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t columns = 100;

std::string verb_of(const std::string& type) { return type.substr(type.find('.') + 1); }

std::string first_sentence(const std::string& doc) {
    const auto end = doc.find(". ");
    return end == std::string::npos ? doc : doc.substr(0, end + 1);
}

/// Wraps a text into indented lines of at most `columns` characters.
std::string wrapped(const std::string& text, std::size_t indent) {
    std::string out;
    std::string line(indent, ' ');
    for (std::size_t at = 0; at < text.size();) {
        const auto end = std::min(text.find_first_of(" \n", at), text.size());
        if (line.size() > indent && line.size() + 1 + end - at > columns) {
            out += line + "\n";
            line.assign(indent, ' ');
        }
        if (line.size() > indent && end > at) line += ' ';
        line += text.substr(at, end - at);
        at = end + 1;
    }
    return out + line + "\n";
}

std::string join(const std::vector<std::string>& parts, const char* between) {
    std::string out;
    for (const auto& part : parts)
        if (!part.empty()) out += (out.empty() ? "" : between) + part;
    return out;
}

std::string default_text(const ParamSpec& spec) {
    return spec.required ? "required"
                         : "default " + (spec.fallback.empty() ? "empty" : spec.fallback);
}

std::string value_text(const ParamSpec& spec) {
    return join({to_text(spec.shape), to_text(spec.unit), to_text(spec.range), default_text(spec)},
                "; ");
}

std::string takes_text(const Registry& registry, const NodeType& type, const InputSpec& input) {
    const auto names = registry.accepted_names(type, input) + (input.optional ? "; optional" : "");
    switch (input.arity) {
        case InputSpec::Arity::one: return names;
        case InputSpec::Arity::list: return "one or a list, each " + names;
        case InputSpec::Arity::named: break;
    }
    return "{name: node, ...}, each " + names;
}

std::string arity_text(const InputSpec& input) {
    switch (input.arity) {
        case InputSpec::Arity::one: return input.optional ? "optional" : "one";
        case InputSpec::Arity::list: return input.optional ? "optional list" : "list";
        case InputSpec::Arity::named: break;
    }
    return input.optional ? "optional named" : "named";
}

std::string gives_text(const Registry& registry, const NodeType& type, const OutputSpec& output) {
    return registry.payload(output.type).name +
           (type.per_frame_outputs ? "" : "; once for the whole sequence");
}

std::string more_outputs_text(const NodeType& type) {
    return fmt::format("One more output for each entry of '{}', with the entry's name and type.",
                       type.outputs_param);
}

/// The parts of a node that are cached by default, in words; empty: none.
std::string kept_text(const NodeType& type) {
    const bool digests = type.digest != typeid(void);
    if (type.kept)
        return fmt::format("Kept in the work folder: results{}.",
                           digests ? ", and what it takes of each frame" : "");
    return digests ? "Kept in the work folder: what it takes of each frame." : "";
}

/// An example value of a shape, as YAML.
std::string sample(const Shape& shape, const Range& range) {
    const auto number = [&](double wanted) {
        return fmt::format("{}", std::clamp(wanted, range.min, range.max));
    };
    switch (shape.kind) {
        case Shape::Kind::boolean: return "true";
        case Shape::Kind::integer:
        case Shape::Kind::number: return number(1);
        case Shape::Kind::text: return "name";
        case Shape::Kind::input_path:
        case Shape::Kind::output_path: return "path/to/file";
        case Shape::Kind::count: return number(-12);
        case Shape::Kind::vector:
            return fmt::format("[{}, {}, {}]", number(0), number(0), number(1));
        case Shape::Kind::interval: return fmt::format("[{}, {}]", number(0), number(1));
        case Shape::Kind::choice: return shape.choices.at(0);
        case Shape::Kind::automatic: return "auto";
        case Shape::Kind::list: return "[" + sample(shape.parts.at(0), range) + "]";
        case Shape::Kind::any_of: return sample(shape.parts.at(0), range);
        case Shape::Kind::map: break;
    }
    if (!shape.parts.empty()) return "{name: " + sample(shape.parts[0], range) + "}";
    std::vector<std::string> fields;
    for (const auto& [name, field] : shape.fields)
        fields.push_back(name + ": " + sample(field, range));
    return "{" + join(fields, ", ") + "}";
}

/// The shortest valid node of a type, as lines of a pipeline's `nodes`.
std::string example(const Registry& registry, const NodeType& type, std::size_t indent) {
    const std::string margin(indent, ' ');
    std::string out = margin + verb_of(type.name) + ":\n" + margin + "  type: " + type.name + "\n";
    std::vector<std::pair<std::string, std::string>> lines;
    for (const auto& input : type.inputs) {
        if (input.optional) continue;
        const auto node = input.arity == InputSpec::Arity::list    ? "[a, b]"
                          : input.arity == InputSpec::Arity::named ? "{a: a, b: b}"
                                                                   : input.name;
        lines.emplace_back(input.name + ": " + node,
                           "node or node.output: " + registry.accepted_names(type, input));
    }
    for (const auto& param : type.params)
        if (param.required)
            lines.emplace_back(param.name + ": " + sample(param.shape, param.range),
                               to_text(param.shape));
    std::size_t widest = 0;
    for (const auto& [line, comment] : lines) widest = std::max(widest, line.size());
    for (const auto& [line, comment] : lines)
        out += fmt::format("{}  {:<{}}  # {}\n", margin, line, widest, comment);
    return out;
}

std::string cell(std::string text) {
    for (auto at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2))
        text.insert(at, "\\");
    std::ranges::replace(text, '\n', ' ');
    return text.empty() ? " " : text;
}

std::string row(const std::vector<std::string>& cells) {
    std::string out = "|";
    for (const auto& each : cells) out += " " + cell(each) + " |";
    return out + "\n";
}

std::string rule(std::size_t cells) {
    std::string out = "|";
    for (std::size_t n = 0; n < cells; ++n) out += "---|";
    return out + "\n";
}

/// The payload types that travel between nodes. A type that is only the digest of a node does not.
std::vector<PayloadType> travelling(const Registry& registry) {
    std::vector<PayloadType> out;
    const auto travels = [&](const PayloadType& payload) {
        for (const auto& [name, type] : registry.nodes()) {
            const auto is = [&](const auto& port) { return port.type == payload.type; };
            if (type.digest == payload.type && std::ranges::none_of(type.inputs, is) &&
                std::ranges::none_of(type.outputs, is))
                return false;
        }
        return true;
    };
    std::ranges::copy_if(registry.payloads(), std::back_inserter(out), travels);
    return out;
}

}  // namespace

std::string listing(const Registry& registry, const std::string& only) {
    const auto wanted = [&](const std::string& name) {
        return only.empty() || family_of(name) == only;
    };
    std::size_t widest = 0;
    for (const auto& [name, type] : registry.nodes())
        if (wanted(name)) widest = std::max(widest, name.size());
    std::string out;
    std::string family;
    for (const auto& [name, type] : registry.nodes()) {
        if (!wanted(name)) continue;
        if (family_of(name) != family) {
            out += (out.empty() ? "" : "\n") + family_of(name) + "\n";
            family = family_of(name);
        }
        out += fmt::format("  {:<{}}  {}\n", name, widest, first_sentence(type.doc));
    }
    return out;
}

std::string describe(const Registry& registry, const NodeType& type) {
    std::string out = type.name + "\n" + wrapped(type.doc, 2);
    const auto field = [&](const std::string& name, const std::string& value,
                           const std::string& doc) {
        out += wrapped(name + ": " + value, 2) + wrapped(doc, 6);
    };
    if (!type.inputs.empty()) out += "\ninputs\n";
    for (const auto& input : type.inputs)
        field(input.name, takes_text(registry, type, input), input.doc);
    if (!type.params.empty()) out += "\nparameters\n";
    for (const auto& param : type.params) field(param.name, value_text(param), param.doc);
    if (!type.outputs.empty() || !type.outputs_param.empty()) out += "\noutputs\n";
    for (const auto& output : type.outputs)
        field(output.name, gives_text(registry, type, output), output.doc);
    if (!type.outputs_param.empty()) out += wrapped(more_outputs_text(type), 2);
    if (const auto kept = kept_text(type); !kept.empty()) out += "\n" + wrapped(kept, 0);
    return out + "\nexample\n" + example(registry, type, 2);
}

std::string to_markdown(const Registry& registry, const NodeType& type) {
    std::string out = fmt::format("### {}\n\n{}\n", type.name, type.doc);
    if (!type.inputs.empty()) {
        out += "\n" + row({"input", "takes", ""}) + rule(3);
        for (const auto& input : type.inputs)
            out += row({"`" + input.name + "`", takes_text(registry, type, input), input.doc});
    }
    if (!type.params.empty()) {
        out += "\n" + row({"parameter", "value", "unit", "default", ""}) + rule(5);
        for (const auto& param : type.params)
            out +=
                row({"`" + param.name + "`",
                     join({to_text(param.shape), to_text(param.range)}, ", "), to_text(param.unit),
                     param.required           ? "required"
                     : param.fallback.empty() ? ""
                                              : "`" + param.fallback + "`",
                     param.doc});
    }
    if (!type.outputs.empty()) {
        out += "\n" + row({"output", "gives", ""}) + rule(3);
        for (const auto& output : type.outputs)
            out += row({"`" + output.name + "`", gives_text(registry, type, output), output.doc});
    }
    if (!type.outputs_param.empty()) out += "\n" + more_outputs_text(type) + "\n";
    if (const auto kept = kept_text(type); !kept.empty()) out += "\n" + kept + "\n";
    return out + "\n```yaml\n" + example(registry, type, 0) + "```\n";
}

std::string family_to_markdown(const Registry& registry, const std::string& family) {
    auto out = fmt::format("## {}\n", family);
    for (const auto& [name, type] : registry.nodes())
        if (family_of(name) == family) out += "\n" + to_markdown(registry, type);
    return out;
}

std::string to_markdown(const Registry& registry) {
    std::string contents;
    std::string body;
    std::string family;
    for (const auto& [name, type] : registry.nodes()) {
        if (family_of(name) != family) {
            family = family_of(name);
            contents += fmt::format("{}- [{}](#{})", contents.empty() ? "" : "\n", family, family);
            body += "\n" + family_to_markdown(registry, family);
        }
        // GitHub drops dots from the anchor of a heading.
        std::string anchor = name;
        std::erase(anchor, '.');
        contents += fmt::format("\n  - [{}](#{}): {}", name, anchor, first_sentence(type.doc));
    }
    std::string out =
        "# Nodes\n\nWritten by `fluidcarve nodes --markdown`. An input takes `node` (its first "
        "output) or `node.output`. Besides its own\n"
        "fields every node takes `doc`, a note for readers, and `cache: true` or `false`: whether "
        "its results are kept in the work folder;\n"
        "for a writer, whether files that are up to date stay as they are. Without `cache`, "
        "results are kept where that saves time.\n\n" +
        contents + "\n" + body + "\n## What travels between nodes\n\n" + row({"type", ""}) +
        rule(2);
    for (const auto& payload : travelling(registry)) out += row({payload.name, payload.doc});
    return out;
}

Json to_json(const Registry& registry, const NodeType& type) {
    Json out{{"name", type.name},
             {"doc", type.doc},
             {"inputs", Json::array()},
             {"params", Json::array()},
             {"outputs", Json::array()}};
    for (const auto& input : type.inputs) {
        auto accepts = Json::array();
        for (const auto& payload : registry.payloads())
            if (registry.accepts(input.type, payload.type)) accepts.push_back(payload.name);
        out["inputs"].push_back({{"name", input.name},
                                 {"type", registry.payload(input.type).name},
                                 {"accepts", accepts},
                                 {"arity", arity_text(input)},
                                 {"doc", input.doc}});
    }
    for (const auto& param : type.params) {
        Json entry{{"name", param.name}, {"value", to_text(param.shape)}};
        if (!param.shape.choices.empty()) entry["choices"] = param.shape.choices;
        if (param.unit != Unit::none) entry["unit"] = to_text(param.unit);
        if (std::isfinite(param.range.min)) entry["min"] = param.range.min;
        if (std::isfinite(param.range.max)) entry["max"] = param.range.max;
        if (param.required) entry["required"] = true;
        else entry["default"] = param.fallback;
        entry["doc"] = param.doc;
        out["params"].push_back(std::move(entry));
    }
    for (const auto& output : type.outputs)
        out["outputs"].push_back({{"name", output.name},
                                  {"type", registry.payload(output.type).name},
                                  {"once", !type.per_frame_outputs},
                                  {"doc", output.doc}});
    if (!type.outputs_param.empty()) out["outputs_from"] = type.outputs_param;
    out["version"] = type.version;
    out["kept"] = type.kept;
    return out;
}

Json family_to_json(const Registry& registry, const std::string& family) {
    Json out{{"nodes", Json::array()}};
    for (const auto& [name, type] : registry.nodes())
        if (family_of(name) == family) out["nodes"].push_back(to_json(registry, type));
    return out;
}

Json to_json(const Registry& registry) {
    Json out{{"nodes", Json::array()}, {"types", Json::array()}};
    for (const auto& [name, type] : registry.nodes())
        out["nodes"].push_back(to_json(registry, type));
    for (const auto& payload : travelling(registry))
        out["types"].push_back({{"name", payload.name}, {"doc", payload.doc}});
    return out;
}

}  // namespace fluidcarve
