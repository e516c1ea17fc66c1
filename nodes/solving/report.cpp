#include "nodes/solving/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace fluidcarve {

nlohmann::ordered_json empty_report(const Seams& seams) {
    return {{"axis", to_text(seams.axis)},
            {"kind", to_text(seams.kind)},
            {"shape", {seams.shape[0], seams.shape[1], seams.shape[2], seams.frames.size()}},
            {"energy", nlohmann::json::array()},
            {"zero_share", nlohmann::json::array()},
            {"wall_s", nlohmann::json::array()}};
}

void describe_seams(const FoundSeams& found, const std::string& prefix, const MarkCounts& marks,
                    nlohmann::ordered_json& report) {
    auto energy = nlohmann::ordered_json::array(), bound = energy, gap = energy;
    for (const auto& seam : found.seams) {
        const auto& least = seam.lower_bound;
        energy.push_back(seam.energy);
        bound.push_back(least ? nlohmann::ordered_json(*least) : nullptr);
        gap.push_back(least && *least > 0
                          ? nlohmann::ordered_json(std::max(seam.energy / *least - 1, 0.0))
                          : nullptr);
    }
    report[prefix + "energy"] = std::move(energy);
    report[prefix + "lower_bound"] = std::move(bound);
    if (prefix.empty()) {
        report["gap"] = std::move(gap);
        report["zero_share"] = found.zero_share;
    }
    if (marks.attract) {
        report[prefix + "attracted"] = found.attracted;
        if (prefix.empty()) report["attracted_left"] = found.attracted_left;
    }
    if (marks.protect) report[prefix + "protected"] = found.blocked;
}

std::vector<double> wall_seconds(const nlohmann::ordered_json& before, const FoundSeams& pairs,
                                 const FoundSeams& found) {
    std::vector<double> out;
    if (before.contains("wall_s")) before.at("wall_s").get_to(out);
    for (const auto* const list : {&pairs.wall_s, &found.wall_s}) {
        out.resize(std::max(out.size(), list->size()));
        for (std::size_t n = 0; n < list->size(); ++n) out[n] += (*list)[n];
    }
    return out;
}

void set_shortfall(nlohmann::ordered_json& report, std::size_t asked, const std::string& no_more) {
    report["asked"] = asked;
    report["no_more"] = no_more;
}

bool falls_short(const nlohmann::ordered_json& report) { return report.contains("no_more"); }

void end_shortfall(nlohmann::ordered_json& report) {
    report.erase("asked");
    report.erase("no_more");
}

void cut_report(nlohmann::ordered_json& report, std::size_t count) {
    for (auto& [name, list] : report.items())
        if (name != "shape" && list.is_array() && list.size() > count)
            list.erase(list.begin() + static_cast<std::ptrdiff_t>(count), list.end());
    if (!falls_short(report)) return;
    if (report.at("energy").size() >= count) end_shortfall(report);
    else report["asked"] = count;
}

std::vector<std::string> seam_warnings(const nlohmann::ordered_json& report) {
    std::vector<std::string> out;
    if (falls_short(report))
        out.push_back(fmt::format("finds {} of {} seams, as many as there is room for in {}",
                                  report.at("energy").size(), report.at("asked").get<std::size_t>(),
                                  report.at("no_more").get<std::string>()));
    else if (report.at("energy").empty())
        out.push_back("`count` comes to no seam: nothing is carved");
    const auto& zero_share = report.at("zero_share");
    if (const auto idle = std::count(zero_share.begin(), zero_share.end(), 1.0); idle > 0)
        out.push_back(
            fmt::format("{} of {} seams take{} no energy at all, so that carving them may change "
                        "nothing visible; `mask.weight` gives empty space an energy of "
                        "its own, and `window: [first, last]` holds seams where the content is",
                        idle, zero_share.size(), idle == 1 ? "s" : ""));
    if (!report.contains("attracted")) return out;
    const auto& attracted = report.at("attracted");
    if (const auto idle = std::count(attracted.begin(), attracted.end(), 0);
        idle > 0 && report.at("kind") == "remove" && report.at("attracted_left").back() > 0)
        out.push_back(
            fmt::format("{} of {} seams take nothing of `attract`, though some of it is left: it "
                        "is out of their window, or the path there is too long; "
                        "seam.greedy sees only vertices beside its path, other solvers see all",
                        idle, attracted.size()));
    return out;
}

}  // namespace fluidcarve
