#include "nodes/params/grid_choice.h"

#include "carve/base/words.h"

#include <fmt/format.h>

namespace fluidcarve {

namespace {

bool parse_kind(const Value& value, ValueReader& reader, GridChoice& out) {
    for (const auto& [name, kind] : ChoiceNames<GridKind>::names) {
        if (value.kind != Value::Kind::scalar || value.text != name) continue;
        out.kind = kind;
        return true;
    }
    const auto best = nearest(value.text, {"float", "vector"});
    reader.fault(value, fmt::format("must be float or vector, not {}{}", value.describe(),
                                    best.empty() ? "" : fmt::format("; did you mean '{}'?", best)));
    return false;
}

}  // namespace

Shape ParamTraits<GridChoice>::shape() {
    const auto kind = ParamTraits<GridKind>::shape();
    return {.kind = Shape::Kind::any_of,
            .parts = {kind,
                      {.kind = Shape::Kind::map,
                       .fields = {{"name", ParamTraits<std::string>::shape()}, {"type", kind}}}}};
}

std::optional<GridChoice> ParamTraits<GridChoice>::parse(const Value& value, ValueReader& reader) {
    GridChoice out;
    if (value.kind == Value::Kind::scalar)
        return parse_kind(value, reader, out) ? std::optional(out) : std::nullopt;
    if (value.kind != Value::Kind::map)
        return reader.unwanted(value, to_text(shape())), std::nullopt;
    bool good = true;
    for (const auto& field : value.fields) {
        if (field.name == "type") {
            good = parse_kind(field.value, reader, out) && good;
        } else if (field.name == "name") {
            const auto name = ParamTraits<std::string>::parse(field.value, reader);
            good = good && name;
            out.name = name.value_or("");
        } else {
            Value key;
            key.mark = field.mark;
            reader.fault(key, fmt::format("has no field '{}'{}", field.name,
                                          did_you_mean(field.name, {"name", "type"})));
            good = false;
        }
    }
    if (good && !value.find("type")) {
        reader.fault(value, "lacks 'type': float or vector");
        good = false;
    }
    return good ? std::optional(out) : std::nullopt;
}

std::string ParamTraits<GridChoice>::text(const GridChoice& choice) {
    const auto kind = ParamTraits<GridKind>::text(choice.kind);
    return choice.name.empty() ? kind : fmt::format("{{name: {}, type: {}}}", choice.name, kind);
}

}  // namespace fluidcarve
