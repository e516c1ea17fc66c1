#include "runtime/html/html_words.h"

#include "graph/text/xml_text.h"
#include "runtime/html/html_parts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace fluidcarve {

std::string plain(const nlohmann::ordered_json& value) {
    if (value.is_string()) return value.get<std::string>();
    if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
    if (value.is_number_integer()) return value.dump();
    if (value.is_number()) return fmt::format("{:.6g}", value.get<double>());
    if (value.is_null()) return "–";
    std::vector<std::string> parts;
    for (const auto& [name, each] : value.items())
        parts.push_back(value.is_object() ? name + ": " + plain(each) : plain(each));
    return fmt::format("{}", fmt::join(parts, ", "));
}

std::string words(std::string name) {
    std::ranges::replace(name, '_', ' ');
    return name;
}

std::vector<double> numbers(const nlohmann::ordered_json& entry, const std::string& field) {
    std::vector<double> out;
    if (const auto list = entry.find(field); list != entry.end() && list->is_array())
        for (const auto& value : *list)
            out.push_back(value.is_number() ? value.get<double>()
                                            : std::numeric_limits<double>::quiet_NaN());
    return out;
}

std::string word(const nlohmann::ordered_json& entry, const std::string& field) {
    const auto found = entry.find(field);
    return found != entry.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::string values_table(const std::vector<std::pair<std::string, const ValueSource*>>& rows) {
    std::string out = "<table class=\"values\"><tbody>\n";
    for (const auto& [name, source] : rows) {
        const auto with = source->with.empty()
                              ? std::string()
                              : fmt::format(" with {}", fmt::join(source->with, ", "));
        out +=
            fmt::format("<tr>{}<td><code>{}</code></td>{}</tr>\n", element("th", name),
                        xml_text(source->value), element("td class=\"from\"", source->from + with));
    }
    return out + "</tbody></table>\n";
}

}  // namespace fluidcarve
