#pragma once

#include "runtime/flow/file_provenance.h"
#include "runtime/flow/setup.h"
#include "runtime/keep/node_log.h"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

namespace fluidcarve {

/// The run's side of one call of a body (Context::Host). Hands on what the body says, and logs it
/// for the cache.
class BodyHost : public Context::Host {
public:
    BodyHost(const FlowSetup& setup, FileProvenance& provenance, std::size_t node)
        : node(node), span(setup.events.work()), setup_(setup), provenance_(provenance) {}

    const std::size_t node;
    WorkTimes::Span span;
    NodeLog log;  ///< to be read once the body has ended

    /// Seconds since the call began.
    double seconds() const;
    /// Share of its work that the body last said is done, 0 to 1.
    double share() const { return share_; }

    /// From now on, `checkpoint` caches what the body has found of its growing result.
    void grows() { grows_ = true; }
    /// The body goes on from what an earlier run found.
    void goes_on_from(const ItemCount& before) { grew(before_ = before); }
    /// States the items that this call finds of a growing result.
    /// @param result  null: the body was stopped, and would have found all that are wanted
    void count_items(const Payload* result, CostSetting& at);

    bool cancelled() const override { return setup_.cancelled(); }
    void warn(const std::string& message) override;
    void warn_at_once(const std::string& message) override;
    void report(const std::string& section, const nlohmann::ordered_json& entry) override;
    Provenance provenance() const override { return provenance_.of(node); }
    void progress(double share) override;
    void checkpoint(const Payload& result) override;

private:
    using Clock = std::chrono::steady_clock;

    const Node& of() const { return setup_.pipeline.nodes[node]; }
    std::size_t wanted() const;
    void grew(const ItemCount& items);

    const FlowSetup& setup_;
    FileProvenance& provenance_;
    const Clock::time_point start_ = Clock::now();
    std::atomic<double> share_{0};
    std::mutex mutex_;
    bool grows_ = false;
    ItemCount before_{}, found_{};  ///< of a growing result: by an earlier run, and so far
    Clock::time_point next_checkpoint_{};
};

}  // namespace fluidcarve
