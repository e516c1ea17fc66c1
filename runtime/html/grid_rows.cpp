#include "runtime/html/grid_rows.h"

#include <fmt/format.h>

namespace fluidcarve {
namespace {

using GridEntry = nlohmann::ordered_json;

/// A number, or the numbers of a list, as text; nothing for anything else.
std::string number_text(const GridEntry& value) {
    if (value.is_number()) return fmt::format("{:.4g}", value.get<double>());
    std::string out;
    if (value.is_array())
        for (const auto& each : value) out += (out.empty() ? "" : ", ") + number_text(each);
    return out;
}

/// Edges of a box, from its two corners.
std::string size_text_of(const GridEntry& box) {
    if (!box.is_array() || box.size() != 2 || box[0].size() != 3 || box[1].size() != 3)
        return "empty";
    std::string out;
    for (std::size_t n = 0; n < 3; ++n)
        if (box[0][n].is_number() && box[1][n].is_number())
            out += (out.empty() ? "" : " × ") +
                   fmt::format("{:.4g}", box[1][n].get<double>() - box[0][n].get<double>());
    return out;
}

}  // namespace

std::vector<std::vector<std::string>> grid_rows(const nlohmann::ordered_json& grids) {
    std::vector<std::vector<std::string>> out;
    for (const auto& [node, entries] : grids.items())
        for (const auto& [name, grid] : entries.items())
            for (const std::string when : {"before", "after"}) {
                const auto side =
                    grid.is_object() && grid.contains(when) && grid.at(when).is_object()
                        ? grid.at(when)
                        : GridEntry::object();
                const auto field = [&side = side](const char* each) {
                    return side.value(each, GridEntry());
                };
                out.push_back({fmt::format("{}.{} {}", node, name, when),
                               size_text_of(field("box")), number_text(field("mass")),
                               number_text(field("highest")), number_text(field("centre")),
                               number_text(field("flicker"))});
            }
    return out;
}

}  // namespace fluidcarve
