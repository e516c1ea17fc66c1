#pragma once

#include "runtime/flow/frame_calls.h"
#include "runtime/flow/read_ahead.h"
#include "runtime/plan/frame_run.h"
#include "runtime/plan/plan.h"
#include "runtime/plan/schedule.h"

#include <tbb/flow_graph.h>

#include <cstddef>
#include <memory>
#include <tuple>
#include <vector>

namespace fluidcarve {

/// A pass of a schedule.
struct ScheduledPass {
    std::size_t number = 0;
    const Plan& plan;
    const Schedule& schedule;
};

/// The TBB flow graph of one pass: frames are admitted, at most `in_flight` at once, go through the
/// pass's nodes along the pipeline's connections, and retire. Each node of the pipeline is a node
/// of the graph. A sequencer follows each gathering node, so that it consumes frames in order.
class PassGraph {
public:
    /// All must outlive it.
    PassGraph(const FlowSetup& setup, BodyCalls& bodies, CachedResults& results,
              const ScheduledPass& pass);
    ~PassGraph();
    PassGraph(const PassGraph&) = delete;
    PassGraph& operator=(const PassGraph&) = delete;

    /// Streams all frames through the graph.
    ConsumedFrames stream();

private:
    using Frame = std::shared_ptr<FrameRun>;
    using Unit = tbb::flow::multifunction_node<Frame, std::tuple<Frame>>;
    /// What is behind the unit of a gathering node.
    struct Gathering {
        std::unique_ptr<tbb::flow::sequencer_node<Frame>> order;
        std::unique_ptr<tbb::flow::function_node<Frame, Frame>> consume;
    };

    static std::vector<std::size_t> indices_of(const std::vector<Schedule::Frame>& frames);
    Frame admit(std::size_t order);
    void retire(FrameRun& frame);
    /// Runs a node in a frame whose inputs have all arrived.
    void work(std::size_t n, FrameRun& frame);
    void add_unit(std::size_t n);
    void add_gathering(std::size_t n);
    void connect(std::size_t n);
    bool gathers(std::size_t n) const;

    const FlowSetup& setup_;
    BodyCalls& bodies_;
    const Pass& pass_;
    const Plan& plan_;
    const Schedule& schedule_;
    const std::vector<Schedule::Frame>& frames_;  ///< `[t]`
    const std::vector<std::size_t> indices_;      ///< of the frames, in order of admission
    const Wiring wiring_;
    FrameCalls calls_;
    ReadAhead ahead_;
    int ends_ = 0;          ///< nodes that no other reads
    std::size_t next_ = 0;  ///< index in `indices_`

    tbb::flow::graph graph_;
    tbb::flow::input_node<std::size_t> source_;
    tbb::flow::limiter_node<std::size_t> limiter_;
    tbb::flow::function_node<std::size_t, Frame> admit_;
    tbb::flow::function_node<Frame, tbb::flow::continue_msg> retire_;
    std::vector<std::unique_ptr<Unit>> units_;  ///< per pipeline node
    std::vector<Gathering> gathering_;          ///< per pipeline node
};

}  // namespace fluidcarve
