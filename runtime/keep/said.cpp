#include "runtime/keep/said.h"

namespace fluidcarve {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

Json to_json(const Said& said) {
    Json out = Json::object();
    if (!said.warnings.empty()) out["warnings"] = said.warnings;
    for (const auto& [section, entry] : said.report) out["report"][section] = entry;
    return out;
}

Said said_in(const Json& header) {
    Said out;
    out.warnings = header.value("warnings", out.warnings);
    if (const auto report = header.find("report"); report != header.end())
        for (const auto& [section, entry] : report->items()) out.report[section] = entry;
    return out;
}

}  // namespace fluidcarve
