#include "nodes/python/python_value.h"

#include "carve/base/numbers.h"
#include "graph/text/yaml_text.h"

#include <cstdint>

namespace fluidcarve {
namespace {

nlohmann::json json_of(const std::string& text) {
    if (text == "true" || text == "false") return text == "true";
    if (const auto whole = number_of<std::int64_t>(text)) return *whole;
    if (const auto number = parse_number(text)) return *number;
    return text;
}

}  // namespace

nlohmann::json PythonValue::json() const {
    if (!list) return json_of(items.front());
    auto out = nlohmann::json::array();
    for (const auto& item : items) out.push_back(json_of(item));
    return out;
}

Shape ParamTraits<PythonValue>::shape() {
    const Shape number{Shape::Kind::number}, truth{Shape::Kind::boolean}, text{Shape::Kind::text};
    return {.kind = Shape::Kind::any_of,
            .parts = {number, truth, text, {.kind = Shape::Kind::list, .parts = {text}}}};
}

std::optional<PythonValue> ParamTraits<PythonValue>::parse(const Value& value,
                                                           ValueReader& reader) {
    if (value.kind == Value::Kind::scalar) return PythonValue{false, {value.text}};
    if (value.kind != Value::Kind::list)
        return reader.unwanted(value, to_text(shape())), std::nullopt;
    PythonValue out{true, {}};
    for (const auto& item : value.items) {
        if (item.kind != Value::Kind::scalar)
            return reader.unwanted(item, "a number, or a text"), std::nullopt;
        out.items.push_back(item.text);
    }
    return out;
}

std::string ParamTraits<PythonValue>::text(const PythonValue& value) {
    if (!value.list) return yaml_scalar(value.items.front());
    std::string out;
    for (const auto& item : value.items) out += (out.empty() ? "" : ", ") + yaml_scalar(item);
    return "[" + out + "]";
}

}  // namespace fluidcarve
