#pragma once

#include "graph/pipeline.h"

#include <chrono>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace fluidcarve {

/// Records when each node's body ran, on which thread, and when results were loaded and cached.
/// Written in Chrome's trace format. Thread-safe.
class RunProfile {
public:
    using Clock = std::chrono::steady_clock;

    explicit RunProfile(const Pipeline& pipeline) : pipeline_(pipeline) {}

    /// An event that lasts from its construction to its destruction.
    class Span {
    public:
        /// @param profile   null: the event is not recorded
        /// @param category  run, consume, digest, finish: a body of the node; load, keep: its kept
        ///   results. Must outlive the profile
        /// @param frame     frame number, if the event belongs to one frame
        Span(RunProfile* profile, const char* category, std::size_t node, std::optional<int> frame)
            : profile_(profile), category_(category), node_(node), frame_(frame) {}
        ~Span() {
            if (profile_) profile_->add(category_, node_, frame_, start_);
        }
        Span(const Span&) = delete;
        Span& operator=(const Span&) = delete;

    private:
        RunProfile* const profile_;
        const char* const category_;
        const std::size_t node_;
        const std::optional<int> frame_;
        const Clock::time_point start_ = Clock::now();
    };

    /// JSON: {"traceEvents": [{"name", "cat", "ph": "X", "ts", "dur", "pid", "tid", "args":
    /// {"type", "frame"}}]}. Times are in microseconds since the construction of the profile,
    /// threads are numbered from 1.
    std::string text() const;

private:
    struct Event {
        const char* category;
        std::size_t node;
        std::optional<int> frame;
        Clock::time_point start, end;
        int thread;
    };
    void add(const char* category, std::size_t node, std::optional<int> frame,
             Clock::time_point start);

    const Pipeline& pipeline_;
    const Clock::time_point start_ = Clock::now();
    mutable std::mutex mutex_;
    std::map<std::thread::id, int> threads_;
    std::vector<Event> events_;
};

}  // namespace fluidcarve
