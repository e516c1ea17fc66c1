#pragma once

#include "carve/base/failure.h"
#include "graph/pipeline.h"
#include "runtime/keep/manifest.h"
#include "runtime/run/request.h"
#include "runtime/tell/profile.h"
#include "runtime/tell/report.h"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace fluidcarve {

// Output at the end of a run.

/// Prints failures, warnings, results and times.
/// @param told  warnings that are already printed
/// @param done  the closing line of a finished run
void tell_outcome(const Report& report, const RunRequest& request,
                  const nlohmann::ordered_json& summary, const std::vector<std::string>& told,
                  const std::string& done);

/// Adds the files that the run read to the manifest. @return the exit code
int save_manifest(Manifest& manifest, const RunRequest& request);

/// Writes the report, the page and the profile, if requested. @return the exit code
int write_reports(const Pipeline& pipeline, const Registry& registry, const RunRequest& request,
                  const nlohmann::ordered_json& summary, const RunProfile& profile,
                  std::filesystem::file_time_type start, int code);

}  // namespace fluidcarve
