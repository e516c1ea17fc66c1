#pragma once

#include "graph/pipeline.h"
#include "runtime/run/request.h"
#include "runtime/tell/exit_codes.h"

#include <functional>

namespace fluidcarve {

/// The verb `plan`: prints the forecast of a run to stdout. Of input files it reads the headers,
/// and hashes the content.
/// @return an exit code
int plan_pipeline(const Pipeline& pipeline, const Registry& registry, const RunRequest& request,
                  bool json);

/// The verb `run`: runs a checked pipeline. Looks at the inputs, makes plan, schedule and forecast,
/// executes, reports. Prints to stderr.
/// @param cancelled  called often; true: stop soon
/// @return an exit code
int run_pipeline(const Pipeline& pipeline, const Registry& registry, const RunRequest& request,
                 const std::function<bool()>& cancelled);

}  // namespace fluidcarve
