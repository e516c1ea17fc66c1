#include "runtime/html/seams_html.h"

#include "carve/base/words.h"
#include "runtime/html/html_parts.h"
#include "runtime/html/html_words.h"
#include "runtime/html/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace fluidcarve {

namespace {

using SeamsEntry = nlohmann::ordered_json;

constexpr double least_gap = 5e-5;  ///< smaller gaps are rounding errors

std::string percent(double share) {
    return fmt::format("{:.{}f} %", share * 100, share < 0.0995 ? 2 : share < 0.995 ? 1 : 0);
}

/// How far energies are above their lower bounds.
struct Gaps {
    explicit Gaps(std::vector<double> gaps) : each(std::move(gaps)) {
        for (const auto gap : each)
            if (std::isfinite(gap)) {
                widest = std::max(widest, gap);
                ++known;
            }
    }
    bool closed() const { return widest < least_gap; }

    std::vector<double> each;  ///< per seam; not finite: its bound is unknown
    double widest = -1;
    std::size_t known = 0;
};

/// The lattice of a report entry in words: ", in a lattice of 28 × 26 × 130 vertices and 6
/// frames".
std::string where(const SeamsEntry& entry) {
    const auto shape = numbers(entry, "shape");
    if (shape.size() != 4 ||
        !std::ranges::all_of(shape, [](double each) { return each >= 0 && each < 1e9; }))
        return {};
    return fmt::format(", in a lattice of {} × {} × {} vertices and {}", shape[0], shape[1],
                       shape[2], counted(static_cast<std::size_t>(shape[3]), "frame"));
}

std::string gaps_told(const Gaps& gaps) {
    if (gaps.known == 0) return {};
    if (gaps.known < gaps.each.size())
        return fmt::format(
            " A lower bound is known for {} of them: no seam can have less energy there, and {} at "
            "most {} more.",
            gaps.known, gaps.known == 1 ? "it has" : "they have", percent(gaps.widest));
    if (gaps.closed()) return " Each is at its lower bound: no seam has less energy.";
    return fmt::format(
        " No seam can have less energy than its lower bound; these have at most {} more.",
        percent(gaps.widest));
}

std::string summary(const SeamsEntry& entry, std::size_t seams, const Gaps& gaps) {
    const bool inserts = word(entry, "kind") == "insert";
    auto out = fmt::format("{} {} across {}", counted(seams, "seam"),
                           inserts ? "inserted" : "removed", word(entry, "axis"));
    if (const auto pairs = numbers(entry, "pair_energy").size(); pairs > 0)
        out += fmt::format(", {} {} in the pair window",
                           pairs == seams ? "as many" : std::to_string(pairs),
                           inserts ? "removed" : "inserted");
    return out + where(entry) + "." + gaps_told(gaps);
}

/// @param prefix  of the entry's fields
std::string energy_plot(const SeamsEntry& entry, const std::string& prefix,
                        const std::string& title) {
    const auto energy = numbers(entry, prefix + "energy"),
               bound = numbers(entry, prefix + "lower_bound");
    if (energy.empty()) return {};
    const bool bounded =
        std::ranges::any_of(bound, [](double value) { return std::isfinite(value); });
    LinePlot plot{title, "seam", {{"energy", energy}}, false, bounded, {}};
    if (bounded) plot.curves.push_back({"bound", bound});
    for (std::size_t n = 0; n < energy.size(); ++n) {
        const bool has = n < bound.size() && std::isfinite(bound[n]);
        plot.notes.push_back(fmt::format("seam {}: energy {:.6g}{}", n + 1, energy[n],
                                         has ? fmt::format(", at least {:.6g}", bound[n]) : ""));
    }
    return "<figure>" + to_svg(plot) +
           "<ul class=\"legend\"><li><i class=\"line\"></i>energy</li>" +
           (bounded ? "<li><i class=\"line bound\"></i>lower bound</li>" : "") + "</ul></figure>\n";
}

std::string gap_plot(const Gaps& gaps) {
    if (gaps.closed() || gaps.known < 2) return {};
    LinePlot plot{
        "Gap to the lower bound, in percent", "seam", {{"gap", gaps.each}}, true, false, {}};
    for (auto& value : plot.curves[0].values) value *= 100;
    for (std::size_t n = 0; n < gaps.each.size(); ++n)
        plot.notes.push_back(std::isfinite(gaps.each[n])
                                 ? fmt::format("seam {}: {}", n + 1, percent(gaps.each[n]))
                                 : "");
    return "<figure>" + to_svg(plot) + "</figure>\n";
}

/// A table of all lists in a report entry that have one value per seam.
std::string all_numbers(const SeamsEntry& entry, std::size_t seams) {
    std::vector<std::string> heads{"seam"};
    std::vector<std::vector<std::string>> rows;
    for (std::size_t n = 0; n < seams; ++n) rows.push_back({std::to_string(n + 1)});
    for (const auto& [field, list] : entry.items()) {
        if (field == "shape" || !list.is_array() || list.size() != seams || seams == 0) continue;
        heads.push_back(field == "wall_s" ? "time" : words(field));
        for (std::size_t n = 0; n < seams; ++n)
            rows[n].push_back(
                field == "wall_s" && list[n].is_number() ? duration_text(list[n].get<double>())
                : field == "gap" && list[n].is_number()  ? percent(list[n].get<double>())
                                                         : plain(list[n]));
    }
    if (heads.size() == 1) return {};
    return "<details><summary>All numbers</summary>\n" + wide_table(heads, rows) + "</details>\n";
}

}  // namespace

std::string seams_html(const nlohmann::ordered_json& entry) {
    const auto seams = numbers(entry, "energy").size();
    const Gaps gaps(numbers(entry, "gap"));
    return element("p", summary(entry, seams, gaps)) + "\n<div class=\"plots\">\n" +
           energy_plot(entry, "", "Energy of each seam") +
           energy_plot(entry, "pair_", "Energy of each seam of the pair window") + gap_plot(gaps) +
           "</div>\n" + all_numbers(entry, seams);
}

}  // namespace fluidcarve
