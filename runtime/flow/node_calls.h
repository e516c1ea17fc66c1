#pragma once

#include "runtime/flow/body_host.h"
#include "runtime/flow/ports.h"
#include "runtime/plan/frame_run.h"

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// Calls the bodies of nodes, one by one, and loads and keeps their results. What a body throws
/// becomes a NodeFailure: an exception that escaped would cancel a whole flow graph. Calls for
/// frames may come from many threads at once, calls for nodes that run once from one.
class NodeCalls {
public:
    /// @param setup  must outlive it
    explicit NodeCalls(const FlowSetup& setup);

    /// Runs or loads a per-frame node in one frame.
    /// @param target  whether the run is for this node's outputs
    void run(std::size_t n, FrameRun& frame, const Wiring& wiring, bool target);
    /// Computes or loads a gathering node's digest of a frame. It becomes the node's only output
    /// in the frame.
    void digest(std::size_t n, FrameRun& frame, const Wiring& wiring);
    /// Has a gathering node consume one frame. To be called in the order of frames.
    /// @param finishes  whether the node will finish
    /// @return false if the frame failed
    bool consume(std::size_t n, FrameRun& frame, const Wiring& wiring, bool finishes);
    /// Finishes a node that has gathered all frames.
    void finish(std::size_t n);
    /// Runs a node once.
    void once(std::size_t n, bool target);
    void load_once(std::size_t n);
    /// Frees what no other node will read, once a node has run.
    void release(std::size_t n);
    /// The node can't finish.
    void lacks_frames(std::size_t n, const std::vector<int>& failed);

    /// Frames now in memory.
    std::atomic<std::size_t> in_flight{0};

    /// Whether the run ended early (Flow::stopped).
    bool stopped() const;
    /// Whether a cached result was missing (Flow::lost).
    bool lost() const { return lost_; }

private:
    using Action = Schedule::Action;
    using Consume = Schedule::Consume;
    using Body = std::function<void(void* ports, Context&)>;

    const Node& node(std::size_t n) const { return setup_.pipeline.nodes[n]; }
    int frame_number(std::size_t t) const { return setup_.timelines.frames()[t]; }
    /// Number of frame `t`; nothing for a node that runs once.
    std::optional<int> frame_at(std::size_t n, std::size_t t) const;

    /// @param frame  null: the call is for all frames
    Context context(BodyHost& host, const FrameRun* frame) const;
    /// @param what  category in the profile
    /// @return false if the body threw
    bool guarded(std::size_t n, std::optional<int> frame, const char* what,
                 const std::function<void()>& body);
    /// Calls a body with connected ports.
    bool call(BodyHost& host, const FrameRun* frame, const char* what, const Body& body);
    /// A call for one frame: tells of it, and keeps its results.
    void call_for_frame(Work work, std::size_t n, FrameRun& frame, const Body& body);
    bool consume_now(BodyHost& host, const FrameRun& frame);
    /// Calls `finish` of a gathering node. If its result grows, it goes on from what is cached.
    void finish_from_cached(BodyHost& host, void* ports, Context& context);
    /// Tells the end of a body that is called once, and keeps what it holds. A failure ends the
    /// run.
    void end_once(BodyHost& host, bool good, bool delivers);

    void fail(std::size_t n, std::optional<int> frame, const std::string& message,
              Failure::Kind kind);
    /// Whether a frame can't be run: a node before failed there, or the run was cancelled.
    bool hopeless(std::size_t n, const FrameRun& frame, const Wiring& wiring) const;
    /// Whether the cache takes an output, or one of `by` that works.
    bool wanted(std::size_t n, std::string_view output, const auto& by, const auto& works) const;
    /// Caches the outputs and the log of a body, if the node is cached.
    void keep(const BodyHost& host, std::size_t t, const std::vector<Payload>& outputs);
    void keep_digest(const BodyHost& host, std::size_t t, const Payload& digest);
    /// Loads a node's cached outputs into `into`. @return false if they are missing
    bool load(std::size_t n, std::size_t t, std::vector<Payload>& into);

    const FlowSetup& setup_;
    const PortIo io_;
    std::vector<Behaviour> behaviours_;
    std::vector<std::size_t> gathered_;  ///< per node: frames that it has consumed
    PortIo::Outputs held_;               ///< of nodes that run once
    /// Per node: those that may still read what it holds.
    std::vector<std::set<std::size_t>> readers_;
    FileProvenance provenance_;
    std::atomic<bool> failed_{false};  ///< a body failed
    std::atomic<bool> fatal_{false};   ///< the failure ends the run even with `keep_going`
    std::atomic<bool> lost_{false};
};

}  // namespace fluidcarve
