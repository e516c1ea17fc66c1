#pragma once

#include "runtime/run/preparation.h"
#include "runtime/run/request.h"

#include <functional>
#include <vector>

namespace fluidcarve {

/// A schedule, and what it lacks.
struct Prerequisites {
    Schedule schedule;
    std::vector<Share> shares;   ///< of the schedule
    std::vector<Fault> missing;  ///< for each node whose results should be in the work folder, and
                                 ///< are not; empty: the run may begin
};

/// Makes the schedule of a run. With `--only` it makes nothing but its targets; with `--wait` it
/// leaves to other runs what is a step of its own on a farm (digests_apart, gathers_apart). If
/// something of that is not in the work folder, it waits as long as `--wait` says: on NFS, files of
/// other machines show late.
/// @param cancelled  asked often while it waits; true: wait no longer
Prerequisites wait_for_prerequisites(const Pipeline& pipeline, Preparation& prepared,
                                     const RunRequest& request,
                                     const std::function<bool()>& cancelled);

}  // namespace fluidcarve
