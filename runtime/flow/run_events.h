#pragma once

#include "runtime/flow/options.h"
#include "runtime/plan/schedule.h"
#include "runtime/tell/costs.h"
#include "runtime/tell/profile.h"
#include "runtime/tell/progress.h"
#include "runtime/tell/report.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// Hands what happens in a run to all that listen: the report, the progress display, the costs and
/// the profile. Thread-safe.
class RunEvents {
public:
    /// @param profile  may be null
    RunEvents(const RunOptions& options, Report& report, Progress& progress, WorkTimes& costs,
              RunProfile* profile)
        : options_(options),
          report_(report),
          progress_(progress),
          costs_(costs),
          profile_(profile) {}

    /// The run begins with a schedule, or begins again with another.
    void begin(const Schedule& schedule);
    void begin_pass(std::size_t pass) { progress_.begin_pass(pass); }
    /// A frame is done with a pass. @param frame  its number
    void passed(int frame) { progress_.passed(frame); }

    /// A body at work, until the span ends: what `call_ended` and `once_call_ended` count.
    WorkTimes::Span work() { return WorkTimes::Span(costs_); }
    /// An event of the profile, until the span ends (RunProfile::Span).
    /// @param happens  false: nothing is recorded
    RunProfile::Span event(const char* category, std::size_t node, std::optional<int> frame,
                           bool happens = true) {
        return {happens ? profile_ : nullptr, category, node, frame};
    }

    /// The body of a node ended for frame `t`.
    /// @param work  Work::frame or Work::consume
    void body_ended(Work work, std::size_t node, std::size_t t, double seconds,
                    std::uint64_t bytes);
    /// A gathering node has consumed frame `t`.
    void gathered(std::size_t node, std::size_t t) { report_.gathered(node, t); }
    /// The call for one frame ended, perhaps with its result kept.
    /// @param good  whether it came to its end
    void call_ended(Work work, std::size_t node, WorkTimes::Span& span, int frame, bool good);
    /// A cached result was loaded.
    void loaded(std::size_t node, WorkTimes::Span& span);
    /// A node that runs once now holds a cached result.
    void holds(std::size_t node, std::uint64_t bytes) { report_.holds(node, bytes); }

    /// A body that is called once has done a share of its work, 0 to 1.
    void advanced(std::size_t node, double share, double seconds);
    /// A growing result has so many items. @param of  how many the node is to find
    void grew(std::size_t node, std::size_t items, std::size_t of) {
        report_.grew(node, items, of);
    }
    /// A body that is called once ended.
    void once_body_ended(std::size_t node, double seconds, std::uint64_t bytes, bool good) {
        report_.ended(node, seconds, bytes, good);
    }
    /// The call of such a body ended, perhaps with its result kept.
    /// @param good   whether it came to its end
    /// @param share  of the work that it did, 0 to 1
    /// @param at     its setting; threads and cores are added here
    void once_call_ended(std::size_t node, WorkTimes::Span& span, bool good, double share,
                         CostSetting at);

    void warned(std::size_t node, const std::string& message) { report_.warn(node, message); }
    /// As `warned`, and shows the warning now.
    void warned_at_once(std::size_t node, const std::string& message);
    /// A body adds an entry to a section of the report.
    void reported(std::size_t node, const std::string& section,
                  const nlohmann::ordered_json& entry) {
        report_.entry(node, section, entry);
    }
    void failed(const NodeFailure& failure) { report_.failed(failure); }

private:
    /// Steps of the progress display; nothing: the run does no such work.
    using Steps = std::array<std::optional<std::size_t>, work_kinds>;
    std::optional<std::size_t> step(std::size_t node, Work work) const {
        return steps_[node][static_cast<std::size_t>(work)];
    }

    const RunOptions& options_;
    Report& report_;
    Progress& progress_;
    WorkTimes& costs_;
    RunProfile* const profile_;
    std::vector<NodeWork> node_work_;  ///< per node
    std::vector<Steps> steps_;         ///< per node
};

}  // namespace fluidcarve
