#pragma once

#include "carve/seam/seams.h"
#include "carve/solver/costs/marks.h"
#include "carve/solver/search/find_seams.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <string>
#include <vector>

/// The report of a seam set: axis, kind and shape; per seam energy, lower_bound, gap, wall_s
/// (seconds) and zero_share (0..1); for pairs also pair_energy and pair_lower_bound. With masks,
/// also the number of marked vertices that each seam passes: attracted, protected (none),
/// pair_attracted, pair_protected; and the number of attracted ones that each seam leaves,
/// attracted_left. If there are fewer seams than asked for (best_effort): asked, their number, and
/// no_more, a text that says why.
namespace fluidcarve {

/// The report of a set without seams.
nlohmann::ordered_json empty_report(const Seams& seams);

/// Describes the seams of a window in a report.
/// @param prefix  of the report's names: empty or `pair_`
/// @param marks   tells which masks there are
void describe_seams(const FoundSeams& found, const std::string& prefix, const MarkCounts& marks,
                    nlohmann::ordered_json& report);

/// Seconds for each seam together with its pair, as far as these were found.
/// @param before  report of an earlier search that is continued; null: none
std::vector<double> wall_seconds(const nlohmann::ordered_json& before, const FoundSeams& pairs,
                                 const FoundSeams& found);

/// Says in a report that there are fewer seams than asked for.
/// @param no_more  why: "window [2, 5]: ..."
void set_shortfall(nlohmann::ordered_json& report, std::size_t asked, const std::string& no_more);
/// Whether a report has a shortfall.
bool falls_short(const nlohmann::ordered_json& report);
/// Removes the shortfall from a report.
void end_shortfall(nlohmann::ordered_json& report);

/// Changes a report to that of the first `count` seams, or of all if there are no more. The
/// shortfall then counts from `count`, too.
void cut_report(nlohmann::ordered_json& report, std::size_t count);

/// Warnings about the seams of a report.
std::vector<std::string> seam_warnings(const nlohmann::ordered_json& report);

}  // namespace fluidcarve
