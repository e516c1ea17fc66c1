#include "runtime/keep/node_log.h"

namespace fluidcarve {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

Json to_json(const NodeLog& log) {
    Json out = Json::object();
    if (!log.warnings.empty()) out["warnings"] = log.warnings;
    for (const auto& [section, entry] : log.report) out["report"][section] = entry;
    return out;
}

NodeLog log_in(const Json& header) {
    NodeLog out;
    out.warnings = header.value("warnings", out.warnings);
    if (const auto report = header.find("report"); report != header.end())
        for (const auto& [section, entry] : report->items()) out.report[section] = entry;
    return out;
}

}  // namespace fluidcarve
