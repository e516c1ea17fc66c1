#include "runtime/keep/grown_result.h"

#include <algorithm>
#include <limits>

namespace fluidcarve {
namespace {

using Json = nlohmann::ordered_json;

std::size_t wanted_by(const Node& node, const ItemCount& items) {
    return node.type->growth->wanted(node.params.get(), items.all_items);
}

}  // namespace

std::optional<GrownResult> GrownResult::in(const Json& header) {
    const auto found = header.find("extent");
    if (found == header.end()) return std::nullopt;
    const ItemCount items{found->at("count").get<std::size_t>(),
                          found->at("of").get<std::size_t>()};
    // Without a size it counts as the largest.
    return GrownResult{items, header.value("size", std::numeric_limits<std::uint64_t>::max()),
                       header.contains("part"), header.contains("exhausted")};
}

void GrownResult::describe(Json& header) const {
    header["size"] = bytes;
    header["extent"] = {{"count", items.count}, {"of", items.all_items}};
    if (part) header["part"] = true;
    if (exhausted) header["exhausted"] = true;
}

bool GrownResult::enough_for(const Node& node) const {
    return items.count >= wanted_by(node, items) || (exhausted && takes_fewer(node));
}

bool GrownResult::fits(const Node& node) const {
    return !part && !exhausted && items.count == wanted_by(node, items);
}

bool GrownResult::holds(const GrownResult& other) const {
    if (items.count != other.items.count) return items.count > other.items.count;
    if (exhausted != other.exhausted) return exhausted;
    // Of pairs of seams, those of one window are found first. So of two parts with as many seams
    // the larger one holds more.
    return (!part || other.part) && bytes >= other.bytes;
}

bool takes_fewer(const Node& node) {
    const auto& growth = node.type->growth;
    return growth && !growth->best_effort.empty() &&
           node.type->param(growth->best_effort)->text(node.params.get()) ==
               ParamTraits<bool>::text(true);
}

void cut(const Node& node, const GrownResult& all, Payload& result, NodeLog& log) {
    if (all.fits(node)) return;
    const auto& growth = *node.type->growth;
    auto entry = grown_entry(log);
    const auto about_all = growth.warnings ? growth.warnings(entry) : std::vector<std::string>();
    result = growth.first(result, wanted_by(node, all.items), entry);
    if (!log.report.empty()) log.report.begin()->second = entry;
    std::erase_if(log.warnings, [&](const std::string& each) {
        return std::ranges::find(about_all, each) != about_all.end();
    });
    if (growth.warnings)
        for (auto& warning : growth.warnings(entry)) log.warnings.push_back(std::move(warning));
}

Json grown_entry(const NodeLog& log) {
    return log.report.empty() ? Json::object() : log.report.begin()->second;
}

}  // namespace fluidcarve
