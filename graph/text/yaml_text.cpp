#include "graph/text/yaml_text.h"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace fluidcarve {

std::string yaml_scalar(const std::string& text, Letters letters) {
    using Json = nlohmann::ordered_json;
    const auto escaped = [&](unsigned char c) {
        return c < 0x20 || c == 0x7f || (letters == Letters::ascii && c > 0x7f);
    };
    const bool marked = text.find_first_of(",[]{}") != std::string::npos ||
                        text.find(": ") != std::string::npos ||
                        text.find(" #") != std::string::npos;
    const bool sign = !text.empty() && std::string("-?:").find(text[0]) != std::string::npos &&
                      (text.size() == 1 || text[1] == ' ');
    const bool plain =
        !text.empty() && text != "~" && text != "null" && text != "Null" && text != "NULL" &&
        !marked && !sign && std::string(" #&*!|>'\"%@`").find(text[0]) == std::string::npos &&
        text.back() != ' ' && text.back() != ':' && std::ranges::none_of(text, escaped);
    return plain ? text
                 : Json(text).dump(-1, ' ', letters == Letters::ascii,
                                   Json::error_handler_t::replace);
}

std::string yaml_text(const Value& value, Letters letters) {
    std::string out;
    const auto put = [&](const std::string& each) { out += (out.empty() ? "" : ", ") + each; };
    switch (value.kind) {
        case Value::Kind::list:
            for (const auto& item : value.items) put(yaml_text(item, letters));
            return "[" + out + "]";
        case Value::Kind::map:
            for (const auto& field : value.fields)
                put(yaml_scalar(field.name, letters) + ": " + yaml_text(field.value, letters));
            return "{" + out + "}";
        case Value::Kind::scalar: return yaml_scalar(value.text, letters);
        case Value::Kind::null:
        case Value::Kind::unresolved: break;
    }
    return "~";
}

}  // namespace fluidcarve
