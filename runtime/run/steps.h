#pragma once

#include "runtime/keep/history.h"
#include "runtime/run/preparation.h"
#include "runtime/run/run_resources.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace fluidcarve {

/// A part of a run that can be a run of its own, on another machine. It finds the results of
/// earlier steps in the work folder.
struct RunStep {
    std::string name;                  ///< unique: `seams-energy`, `seams`, `out`
    std::string what;                  ///< what it does, in words
    RunTarget target;                  ///< the part of the pipeline that it runs
    std::vector<std::size_t> needs{};  ///< indices of the steps that it waits for directly
    bool chunked = false;              ///< several runs, each of some frames, give the same result
                                       ///< as one run
    std::vector<int> frames{};  ///< numbers of the frames that it digests or delivers; empty, if it
                                ///< is not chunked
    /// Resources of one run. @param frames  that it takes, if the step is chunked
    std::function<RunResources(std::size_t frames)> resources{};
};

/// Cuts a run into steps, each after those that it needs: for every gathering node with digests a
/// step that makes these, for every node with one result of all frames (gathers_apart) a step that
/// runs it, and then the steps that deliver. Nodes that deliver frames from one and the same
/// computation share a step. So each kept result is computed once in all steps, whatever the work
/// folder holds at present.
std::vector<RunStep> steps_of(const Pipeline& pipeline, const Preparation& prepared,
                              const History& history, const RunOptions& options);

/// The steps for programs, as `plan --json` prints them (pipelines/FORMATS.md).
nlohmann::ordered_json to_json(const std::vector<RunStep>& steps);

}  // namespace fluidcarve
