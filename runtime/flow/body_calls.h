#pragma once

#include "runtime/flow/body_host.h"
#include "runtime/flow/phase.h"
#include "runtime/flow/ports.h"
#include "runtime/plan/frame_run.h"

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// Calls bodies of nodes, one by one. What a body throws becomes a NodeFailure: an exception that
/// escaped would cancel a whole flow graph. Calls for frames may come from many threads at once.
class BodyCalls {
public:
    using Body = std::function<void(void* ports, Context&)>;

    /// Both must outlive it.
    /// @param held  outputs of nodes that run once
    BodyCalls(const FlowSetup& setup, const PortIo::Outputs& held);

    const Behaviour& behaviour(std::size_t n) const { return behaviours_[n]; }
    /// The run's side of the next call of a node.
    BodyHost host(std::size_t n) { return {setup_, provenance_, n}; }
    /// Calls a body with connected ports.
    /// @param frame  null: the call is for all frames
    /// @return false if the body threw
    bool call(BodyHost& host, const FrameRun* frame, Phase phase, const Body& body);
    /// Calls a body that needs no ports for one frame.
    bool call_without_ports(BodyHost& host, const FrameRun& frame, Phase phase,
                            const std::function<void(Context&)>& body);

    /// Tells that a node failed.
    /// @param frame  its number; nothing: for all frames
    void fail(std::size_t n, std::optional<int> frame, const std::string& message,
              Failure::Kind kind);
    /// A failure ends the run even with `keep_going`.
    void end_run() { fatal_ = true; }
    /// Whether the run was cancelled, or ends after a failure.
    bool stopped() const;

    /// Frames now in memory.
    std::atomic<std::size_t> in_flight{0};

private:
    std::optional<int> number(const FrameRun* frame) const;
    Context context(BodyHost& host, const FrameRun* frame) const;
    bool guarded(std::size_t n, std::optional<int> frame, Phase phase,
                 const std::function<void()>& body);

    const FlowSetup& setup_;
    const PortIo io_;
    const PortIo::Outputs& held_;
    std::vector<Behaviour> behaviours_;
    FileProvenance provenance_;
    std::atomic<bool> failed_{false};  ///< a body failed
    std::atomic<bool> fatal_{false};
};

}  // namespace fluidcarve
