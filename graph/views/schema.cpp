#include "graph/views/schema.h"

#include "graph/text/json_text.h"
#include "graph/types/file_fields.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <map>
#include <span>

namespace fluidcarve {
namespace {

using Json = nlohmann::ordered_json;

Json defined(const std::string& definition) { return {{"$ref", "#/definitions/" + definition}}; }

Json any_of(std::vector<Json> alternatives) { return {{"anyOf", std::move(alternatives)}}; }

/// A number, or a text with a number: `check` reads a quoted number as a number where the
/// declaration wants one.
Json number(const char* type, const Range& range) {
    Json out{{"type", type}};
    if (std::isfinite(range.min)) out["minimum"] = range.min;
    if (std::isfinite(range.max)) out["maximum"] = range.max;
    return any_of({out, defined("number_text")});
}

Json numbers(std::size_t size, const Range& range) {
    return {{"type", "array"},
            {"items", any_of({number("number", range), defined("insertion")})},
            {"minItems", size},
            {"maxItems", size}};
}

Json value_of(const Shape& shape, const Range& range);

Json form_of(const Shape& shape, const Range& range) {
    switch (shape.kind) {
        case Shape::Kind::boolean:
            return any_of({Json{{"type", "boolean"}}, Json{{"enum", {"true", "false"}}}});
        case Shape::Kind::integer: return number("integer", range);
        case Shape::Kind::number: return number("number", range);
        case Shape::Kind::count:
            return any_of({number("integer", range),
                           Json{{"type", "string"}, {"pattern", "^[-+]?[0-9]+(\\.[0-9]*)?%$"}}});
        case Shape::Kind::vector: return numbers(3, range);
        case Shape::Kind::interval: return numbers(2, range);
        case Shape::Kind::choice: return {{"enum", shape.choices}};
        case Shape::Kind::automatic:
            return any_of({Json{{"const", "auto"}}, form_of(shape.parts.at(0), range)});
        case Shape::Kind::list:
            return {{"type", "array"}, {"items", value_of(shape.parts.at(0), range)}};
        case Shape::Kind::input_path:
        case Shape::Kind::output_path: return {{"type", "string"}};
        // `check` reads an unquoted 12 or true as a text where the declaration wants one.
        case Shape::Kind::text: return {{"type", {"string", "number", "boolean"}}};
        case Shape::Kind::any_of: {
            std::vector<Json> alternatives;
            for (const auto& each : shape.parts) alternatives.push_back(form_of(each, range));
            return any_of(std::move(alternatives));
        }
        case Shape::Kind::map: break;
    }
    Json out{{"type", "object"}};
    if (!shape.parts.empty())
        return out["additionalProperties"] = value_of(shape.parts[0], range), out;
    out["properties"] = Json::object();
    for (const auto& [name, field] : shape.fields) out["properties"][name] = value_of(field, range);
    out["additionalProperties"] = false;
    return out;
}

/// A value of the shape, or `${name}`.
Json value_of(const Shape& shape, const Range& range) {
    const bool text = shape.kind == Shape::Kind::text || shape.kind == Shape::Kind::input_path ||
                      shape.kind == Shape::Kind::output_path;
    return text ? form_of(shape, range) : any_of({form_of(shape, range), defined("insertion")});
}

/// The default of a parameter as JSON; null if its YAML text is not valid JSON.
Json default_of(const ParamSpec& spec) {
    switch (spec.shape.kind) {
        case Shape::Kind::text:
        case Shape::Kind::input_path:
        case Shape::Kind::output_path:
        case Shape::Kind::choice: return spec.fallback;
        default: break;
    }
    auto parsed = Json::parse(spec.fallback, nullptr, false);
    if (!parsed.is_discarded()) return parsed;
    const bool scalar = spec.fallback.find_first_of("[{") == std::string::npos;
    return scalar && !spec.fallback.empty() ? Json(spec.fallback) : Json();
}

std::string description_of(const ParamSpec& spec) {
    auto out = spec.doc;
    if (spec.unit != Unit::none) out += fmt::format(" Unit: {}.", to_text(spec.unit));
    if (!spec.required && !spec.fallback.empty())
        out += fmt::format(" Default: {}.", spec.fallback);
    return out;
}

Json field_of(const InputSpec& input, const NodeType& type, const Registry& registry) {
    Json out;
    if (input.arity == InputSpec::Arity::list)
        out = any_of({defined("port"),
                      Json{{"type", "array"}, {"items", defined("port")}, {"minItems", 1}}});
    else if (input.arity == InputSpec::Arity::named)
        out = {{"type", "object"}, {"additionalProperties", defined("port")}};
    else
        out = {{"allOf",
                Json::array({defined("port")})}};  // draft 7 ignores a description beside a $ref
    out["description"] =
        fmt::format("{} Takes {}.", input.doc, registry.accepted_names(type, input));
    return out;
}

/// Properties of an object, described. @param forms  the form of each field, by its name
Json properties_of(std::span<const FileField> fields,
                   const std::map<std::string_view, Json>& forms) {
    auto out = Json::object();
    for (const auto& field : fields) {
        auto& property = out[std::string(field.name)] = forms.at(field.name);
        property["description"] = field.doc;
    }
    return out;
}

/// Fields of every node whose form does not depend on its type.
std::vector<std::string> plain_fields() {
    auto out = names_of(common_fields);
    std::erase(out, "type");
    return out;
}

/// Schema of the fields that a node of the type may have.
Json fields_of(const NodeType& type, const Registry& registry) {
    Json properties{{"type", {{"const", type.name}, {"description", type.doc}}}};
    for (const auto& input : type.inputs) properties[input.name] = field_of(input, type, registry);
    for (const auto& param : type.params) {
        auto& property = properties[param.name] = value_of(param.shape, param.range);
        property["description"] = description_of(param);
        if (param.required) continue;
        if (auto fallback = default_of(param); !fallback.is_null())
            property["default"] = std::move(fallback);
    }
    for (const auto& name : plain_fields()) properties[name] = defined(name);
    return {{"type", "object"},
            {"description", type.doc},
            {"properties", std::move(properties)},
            {"additionalProperties", false}};
}

Json required_of(const NodeType& type) {
    auto out = Json::array({"type"});
    for (const auto& input : type.inputs)
        if (!input.optional) out.push_back(input.name);
    for (const auto& param : type.params)
        if (param.required) out.push_back(param.name);
    return out;
}

/// The same for a file with `extends`: each field may also be null, and so may fields of another
/// type that the node has in the extended file.
Json fields_to_change(const NodeType& type) {
    Json properties{{"type", Json::object()}};
    for (const auto& name : plain_fields())
        properties[name] = any_of({defined(name), Json{{"type", "null"}}});
    for (const auto& name : type.field_names())
        properties[name] =
            any_of({defined(type.name + "/properties/" + name), Json{{"type", "null"}}});
    return {{"properties", std::move(properties)}, {"additionalProperties", {{"type", "null"}}}};
}

Json if_type(const std::string& name, Json then) {
    return {{"if", {{"properties", {{"type", {{"const", name}}}}}, {"required", {"type"}}}},
            {"then", std::move(then)}};
}

/// @param whole  true: a complete node; false: a node that may change a node of an extended file
Json node_of(const Registry& registry, bool whole) {
    Json out{{"type", whole ? Json("object") : Json::array({"object", "null"})}};
    if (whole) out["required"] = {"type"};
    out["properties"] = {{"type",
                          {{"enum", registry.node_names()},
                           {"description", find_field(common_fields, "type")->doc}}}};
    out["allOf"] = Json::array();
    for (const auto& [name, type] : registry.nodes())
        out["allOf"].push_back(if_type(
            name, whole ? Json{{"allOf", Json::array({defined(name),
                                                      Json{{"required", required_of(type)}}})}}
                        : fields_to_change(type)));
    return out;
}

Json param_of(bool whole) {
    auto defaults = Json::array();
    for (const auto& type : param_types())
        defaults.push_back(if_type(
            type.name, {{"properties", {{"default", value_of(type.shape, any_number())}}}}));
    Json out{{"type", whole ? Json("object") : Json::array({"object", "null"})}};
    if (whole) out["required"] = {"type"};
    const Json bound{{"type", "number"}};
    out["properties"] =
        properties_of(param_fields, {{"type", Json{{"enum", names_of(param_types())}}},
                                     {"default", Json::object()},
                                     {"min", bound},
                                     {"max", bound},
                                     {"doc", Json{{"type", "string"}}}});
    out["additionalProperties"] = false;
    out["allOf"] = std::move(defaults);
    return out;
}

/// The parts that properties refer to.
Json definitions_of(const Registry& registry) {
    Json out{{"insertion",
              {{"description",
                "Text with ${name}: a param, or an environment variable named under `env`."},
               {"type", "string"},
               {"pattern", "\\$\\{[^}]+\\}"}}},
             {"number_text",
              {{"type", "string"},
               {"pattern", "^[-+]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][-+]?[0-9]+)?$"}}},
             {"port",
              {{"description", "node or node.output"},
               {"type", "string"},
               {"pattern", "^[A-Za-z0-9_-]+(\\..+)?$|\\$\\{[^}]+\\}"}}},
             {"cache", value_of({Shape::Kind::boolean}, any_number())},
             {"doc", {{"description", find_field(common_fields, "doc")->doc}, {"type", "string"}}},
             {"param", param_of(true)},
             {"param_change", param_of(false)},
             {"node", node_of(registry, true)},
             {"node_change", node_of(registry, false)}};
    out["cache"]["description"] = find_field(common_fields, "cache")->doc;
    for (const auto& [name, type] : registry.nodes()) out[name] = fields_of(type, registry);
    return out;
}

/// The fields at the top of a file.
Json top_properties() {
    constexpr auto frames =
        "^auto$|^\\s*-?[0-9]+(--?[0-9]+([xy:]-?[0-9]+)?)?(\\s*,\\s*-?[0-9]+(--?[0-9]+([xy:]-?[0-9]+"
        ")?)?)*\\s*$";
    return properties_of(
        top_fields,
        {{"fluidcarve", Json{{"const", 1}}},
         {"plugins",
          Json{{"type", Json::array({"array", "null"})}, {"items", {{"type", "string"}}}}},
         {"params", Json{{"type", "object"}}},
         {"env", Json{{"type", "array"}, {"items", {{"type", "string"}}}}},
         {"extends", Json{{"type", "string"}}},
         {"provenance", value_of({Shape::Kind::boolean}, any_number())},
         {"frames", Json{{"anyOf", Json::array({Json{{"type", "integer"}},
                                                Json{{"type", "string"}, {"pattern", frames}},
                                                defined("insertion"), Json{{"type", "null"}}})}}},
         {"nodes",
          Json{{"type", "object"}, {"propertyNames", {{"pattern", "^[A-Za-z0-9_-]+$"}}}}}});
}

}  // namespace

std::string schema(const Registry& registry) {
    const auto map_of = [](const std::string& definition) {
        return Json{{"additionalProperties", defined(definition)}};
    };
    const Json out{
        {"$schema", "http://json-schema.org/draft-07/schema#"},
        {"title", "fluidcarve pipeline"},
        {"type", "object"},
        {"properties", top_properties()},
        {"additionalProperties", false},
        {"if", {{"required", {"extends"}}}},
        {"then",
         {{"properties", {{"params", map_of("param_change")}, {"nodes", map_of("node_change")}}}}},
        {"else",
         {{"required", {"fluidcarve", "nodes"}},
          {"properties", {{"params", map_of("param")}, {"nodes", map_of("node")}}}}},
        {"definitions", definitions_of(registry)}};
    return json_text(out, 2) + "\n";
}

}  // namespace fluidcarve
