#include "runtime/run/run_end.h"

#include "carve/base/words.h"
#include "formats/file/output_file.h"
#include "graph/text/json_text.h"
#include "runtime/html/html_report.h"
#include "runtime/tell/exit_codes.h"
#include "runtime/tell/outcome.h"
#include "runtime/tell/terminal.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <ctime>

namespace fluidcarve {
namespace {

/// Writes a text.
/// @param what  name of the file's kind, for messages
/// @return `code`, or another exit code if writing fails
int write_file(const char* what, const std::string& path, const std::string& text, int code) {
    try {
        OutputFile::write(path, text);
        return code;
    } catch (const Failure& failure) {
        tell(fmt::format("failed: {}: {}", what, failure.what()));
        return code == exit_code::done ? exit_code::node_failed : code;
    }
}

}  // namespace

void tell_outcome(const Report& report, const RunRequest& request,
                  const nlohmann::ordered_json& summary, const std::vector<std::string>& told,
                  const std::string& done) {
    constexpr std::size_t most = 20;
    const auto failures = report.failures();
    for (std::size_t n = 0; n < std::min(most, failures.size()); ++n)
        tell("failed: " + to_text(failures[n]));
    if (failures.size() > most)
        tell(fmt::format("... and {} more; --report FILE.json lists them all",
                         failures.size() - most));
    if (request.quiet) return;
    for (const auto& warning : report.warnings())
        if (std::ranges::find(told, warning) == told.end()) tell("warning: " + warning);
    for (const auto& line : report.lines()) tell(line);
    if (failures.empty() && summary["exit"] == exit_code::done) tell(done);
    if (summary["exit"] == exit_code::interrupted) tell(interrupted_text(request.options.cache));
    if (request.verbose)
        for (const auto& [name, node] : summary["nodes"].items())
            tell(fmt::format(
                "{:>10.3f} s  {:>13}  {:>10.1f} MB  {} ({})", node["wall_s"].get<double>(),
                counted(node["frames"].get<std::size_t>(), "frame"),
                node["bytes"].get<double>() / 1e6, name, node["type"].get<std::string>()));
}

int save_manifest(Manifest& manifest, const RunRequest& request) {
    try {
        const auto [listed, added] = manifest.save();
        if (!request.quiet)
            tell(fmt::format("manifest {}: {} unchanged, {} added", request.manifest_path,
                             counted(listed, "file"), added));
        return exit_code::done;
    } catch (const Failure& failure) {
        tell(fmt::format("failed: manifest: {}", failure.what()));
        return exit_code::of(failure);
    }
}

int write_reports(const Pipeline& pipeline, const Registry& registry, const RunRequest& request,
                  const nlohmann::ordered_json& summary, const RunProfile& profile,
                  std::filesystem::file_time_type start, int code) {
    if (!request.report_path.empty())
        code = write_file("report", request.report_path, json_text(summary, 2) + "\n", code);
    if (!request.profile_path.empty())
        code = write_file("profile", request.profile_path, profile.text(), code);
    if (request.html_path.empty()) return code;
    const auto files = written_files(pipeline, summary["frames"].get<std::vector<int>>(), summary,
                                     start, request.html_path);
    const auto when = fmt::format("{:%Y-%m-%d %H:%M}", fmt::localtime(std::time(nullptr)));
    return write_file("page", request.html_path,
                      to_html({pipeline, registry, request.sources, summary, files, when}), code);
}

}  // namespace fluidcarve
