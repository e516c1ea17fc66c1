#pragma once

#include "runtime/flow/body_calls.h"
#include "runtime/flow/cached_results.h"
#include "runtime/plan/frame_run.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace fluidcarve {

/// What a pass did for its gathering nodes; per pipeline node.
struct ConsumedFrames {
    std::vector<std::size_t> count;  ///< of the frames that it consumed
    /// Numbers of the frames that failed before it, or there.
    std::vector<std::vector<int>> failed;
};

/// What the nodes of one pass do in a frame: per-frame nodes `run`; gathering nodes `digest` the
/// frame, then `consume` it. Calls may come from many threads at once.
class FrameCalls {
public:
    /// All must outlive it.
    FrameCalls(const FlowSetup& setup, BodyCalls& bodies, CachedResults& results,
               const Wiring& wiring);

    /// Runs or loads a per-frame node in one frame.
    /// @param target  whether the run is for this node's outputs
    void run(std::size_t n, FrameRun& frame, bool target);
    /// Computes or loads a gathering node's digest of a frame, if it makes digests. It becomes the
    /// node's only output in the frame.
    void digest(std::size_t n, FrameRun& frame);
    /// Has a gathering node consume one frame. To be called in the order of frames.
    /// @param finishes  whether the node will finish
    void consume(std::size_t n, FrameRun& frame, bool finishes);

    /// What was consumed. To be called once, after the last frame.
    ConsumedFrames consumed() { return std::move(consumed_); }

    /// Whether no more frames are to start (Flow::stopped).
    bool stopped() const { return bodies_.stopped() || results_.lost(); }

private:
    using Action = Schedule::Action;
    using Consume = Schedule::Consume;

    int number(const FrameRun& frame) const { return setup_.timelines.frames()[frame.t]; }
    /// Whether a frame can't be run: a node before failed there, or the run was cancelled.
    bool hopeless(std::size_t n, const FrameRun& frame) const;
    /// Calls a body: tells of it, and keeps its results.
    void call(Work work, std::size_t n, FrameRun& frame, const BodyCalls::Body& body);
    void run_body(std::size_t n, FrameRun& frame, bool target);
    /// Calls the node's `add` with the inputs of a frame, or with their digest.
    bool call_add(BodyHost& host, const FrameRun& frame);
    /// @return whether the frame was good
    bool consume_scheduled(std::size_t n, const FrameRun& frame, bool finishes);

    const FlowSetup& setup_;
    BodyCalls& bodies_;
    CachedResults& results_;
    const Wiring& wiring_;
    const PortIo io_;
    ConsumedFrames consumed_;
};

}  // namespace fluidcarve
