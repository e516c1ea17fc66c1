#include "tools/wedge/wedge_page.h"

#include "carve/base/words.h"
#include "formats/file/input_file.h"
#include "graph/text/xml_text.h"
#include "runtime/html/html_parts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <numeric>
#include <optional>

namespace fluidcarve {
namespace {

using WedgeJson = nlohmann::ordered_json;

/// "-12.3 %".
std::string change_text(double before, double after) {
    return fmt::format("{:+.1f} %", 100 * (after / before - 1));
}

/// The axis along which a box changed most, and by how much: "x -12.3 %"; nothing if there is no
/// box.
std::optional<std::string> resized(const WedgeJson& before, const WedgeJson& after) {
    if (!before.contains("box") || !after.contains("box")) return std::nullopt;
    const auto size = [](const WedgeJson& grid, std::size_t n) {
        return grid["box"][1][n].get<double>() - grid["box"][0][n].get<double>();
    };
    std::size_t most = 0;
    double change = -1;
    for (std::size_t n = 0; n < 3; ++n)
        if (const double each = std::abs(size(after, n) / size(before, n) - 1); each > change)
            change = each, most = n;
    return fmt::format("{} {}", "xyz"[most], change_text(size(before, most), size(after, most)));
}

std::string grid_result(const std::string& node, const std::string& name, const WedgeJson& grid) {
    const auto& before = grid.at("before");
    const auto& after = grid.at("after");
    auto out = fmt::format("{}.{}:", node, name);
    if (const auto size = resized(before, after)) out += " " + *size;
    if (before.value("mass", 0.0) > 0 && after.contains("mass"))
        out += ", mass " + change_text(before["mass"].get<double>(), after["mass"].get<double>());
    return out;
}

/// By how much a warp makes the lattice longer: "-7.25 vertices", "-12 to 0 vertices", or the text
/// of a curve.
std::string amount_text(const WedgeJson& warp) {
    if (warp.contains("amounts"))
        return fmt::format("{:g} to {:g} vertices", warp["amounts"][0].get<double>(),
                           warp["amounts"][1].get<double>());
    const auto amount = warp.value("amount", WedgeJson(0.0));
    return amount.is_number() ? fmt::format("{:g} vertices", amount.get<double>())
                              : amount.get<std::string>();
}

/// A picture of a run; or why there is none.
std::string run_picture(const std::string& name, const std::string& path) {
    try {
        return picture_figure(fmt::format("{}: {}", name, path),
                              InputFile(path, {.what = "a picture"}).whole());
    } catch (const Unreadable& unreadable) {
        return element("p class=\"bad\"", fmt::format("{} {}", path, unreadable.fault)) + "\n";
    }
}

std::string run_section(const WedgeResult& run) {
    std::vector<std::string> texts;
    for (const auto& [target, value] : run.differs)
        texts.push_back(fmt::format("{} = {}", target, value));
    const auto name = fmt::format("{}", fmt::join(texts, ", "));
    auto out = element("h2", name) + "\n";
    for (const auto& line : run.results)
        out += element(run.failed ? "p class=\"bad\"" : "p", line) + "\n";
    if (!run.picture.empty()) out += run_picture(name, run.picture);
    if (!run.report.empty())
        out +=
            fmt::format("<p><a href=\"{}\">The report of this run</a></p>\n", xml_text(run.report));
    return out;
}

}  // namespace

std::vector<std::string> wedge_results(const WedgeJson& report) {
    std::vector<std::string> out;
    for (const auto& failure : report.at("failures"))
        out.push_back(fmt::format("failed: {}: {}", failure.at("node").get<std::string>(),
                                  failure.at("message").get<std::string>()));
    for (const auto& [name, entry] : report.at("seams").items()) {
        if (!entry.contains("energy")) continue;
        const auto energy = entry["energy"].get<std::vector<double>>();
        const bool inserted = entry.value("kind", "") == "insert";
        out.push_back(fmt::format("{}: {} {}, energy {:.4g}", name, counted(energy.size(), "seam"),
                                  inserted ? "inserted" : "removed",
                                  std::accumulate(energy.begin(), energy.end(), 0.0)));
    }
    if (report.contains("warp"))
        for (const auto& [name, entry] : report["warp"].items())
            out.push_back(fmt::format("{}: a warp by {}", name, amount_text(entry)));
    if (report.contains("grids"))
        for (const auto& [node, grids] : report["grids"].items())
            if (!grids.empty())
                out.push_back(grid_result(node, grids.begin().key(), *grids.begin()));
    return out;
}

std::string wedge_page(const std::string& pipeline, const std::string& when,
                       const std::string& view, const std::vector<WedgeResult>& results) {
    auto out = page_begin("wedge of " + pipeline);
    out +=
        element("p class=\"eyebrow\"", fmt::format("fluidcarve {}, {}", FLUIDCARVE_VERSION, when)) +
        "\n";
    out += element("h1", "Wedge of " + pipeline) + "\n";
    std::vector<std::string> heads;
    for (const auto& [target, value] : results.front().differs) heads.push_back(target);
    heads.emplace_back("result");
    std::vector<std::vector<std::string>> rows;
    for (const auto& each : results) {
        rows.emplace_back();
        for (const auto& [target, value] : each.differs) rows.back().push_back(value);
        rows.back().push_back(fmt::format("{}", fmt::join(each.results, "; ")));
    }
    out += wide_table(heads, rows);
    if (!view.empty())
        out += fmt::format(
            "<p><a href=\"{}\">All of them side by side, to turn, play and carve</a></p>\n",
            xml_text(view));
    for (const auto& each : results) out += run_section(each);
    return out + "</body>\n</html>\n";
}

}  // namespace fluidcarve
