#pragma once

#include "graph/pipeline.h"
#include "runtime/plan/schedule.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// A run that has done what was asked for.
struct Outcome {
    std::size_t frames = 0;  ///< delivered
    double seconds = 0;
    bool idle = false;  ///< nothing had to be done
    /// Paths of the files that it wrote, or found up to date, with frame tokens.
    std::vector<std::string> paths;
};
/// "done: 6 frames in 12.3 s -> out/plume.####.vdb, out/plume.png"; "done: nothing had to be done,
/// all is there already: 6 frames -> ...".
std::string done_text(const Outcome& outcome);

/// What an interrupted run tells. @param kept  whether the work folder keeps what was computed
std::string interrupted_text(bool kept);

/// Whether all results of a run exist before it begins. @param demands  one per node
bool nothing_to_do(const std::vector<NodeDemand>& demands);
/// The paths of the writers that take part in a run, as the pipeline states them, each once.
std::vector<std::string> written_paths(const Pipeline& pipeline,
                                       const std::vector<NodeDemand>& demands);
/// Largest number of frames of any writer of a file per frame; downstream of a node that retimes,
/// it differs from the number read. Nothing: there is no such writer.
std::optional<std::size_t> written_frames(const Pipeline& pipeline,
                                          const std::vector<NodeDemand>& demands);

}  // namespace fluidcarve
