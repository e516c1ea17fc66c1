#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// One of the runs of a wedge.
struct WedgeResult {
    /// What it differs in, and its values.
    std::vector<std::pair<std::string, std::string>> differs;
    std::vector<std::string> results;  ///< wedge_results() of its report
    bool failed = false;
    std::string picture;  ///< path of its PNG file; empty: none
    std::string view;     ///< path of its preview.page; empty: none
    std::string report;   ///< path of its own page, from that of the wedge
};

/// What a run did, in lines: its failures; of each solver its seams and their energy, or the amount
/// of its warp; of each carved volume how much smaller or larger its first grid became, and its
/// mass.
/// @param report  as Report::to_json returns it
std::vector<std::string> wedge_results(const nlohmann::ordered_json& report);

/// All runs of a wedge as one page: a table, and the picture of each. Self-contained and without
/// scripts.
/// @param when  time of the runs, as text
/// @param view  path of the page to choose by, from this one; empty: there is none
std::string wedge_page(const std::string& pipeline, const std::string& when,
                       const std::string& view, const std::vector<WedgeResult>& results);

}  // namespace fluidcarve
