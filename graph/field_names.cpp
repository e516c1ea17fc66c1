#include "graph/field_names.h"

#include "carve/base/words.h"
#include "graph/types/file_fields.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

namespace fluidcarve {

void check_field_names(const Value& node, const Mark& type, const NodeType& node_type,
                       const std::vector<Mark>& sources, Problems& problems) {
    const auto file = [&](const Mark& mark) {
        return std::ranges::find(sources, mark.source, &Mark::source);
    };
    std::vector<std::string> left, drops;
    for (const auto& each : node.fields) {
        if (find_field(common_fields, each.name)) continue;
        if (node_type.input(each.name) || node_type.param(each.name)) {
            if (each.value.kind == Value::Kind::null)
                add(problems, each.mark,
                    fmt::format("{} field '{}' has no value", node_type.name, each.name));
        } else if (file(each.mark) != sources.end() && file(each.mark) > file(type)) {
            left.push_back(
                fmt::format("'{}' ({}:{})", each.name, each.mark.source->name, each.mark.line));
            drops.push_back(each.name + ": null");
        } else {
            add(problems, each.mark,
                fmt::format("{} has no parameter '{}'{}", node_type.name, each.name,
                            did_you_mean(each.name, node_type.field_names())));
        }
    }
    if (!left.empty())
        add(problems, type,
            fmt::format("{} has no {}, which the extended file states for another type: drop {} "
                        "here with `{}`",
                        node_type.name, fmt::join(left, ", "), left.size() == 1 ? "it" : "them",
                        fmt::join(drops, ", ")));
}

}  // namespace fluidcarve
