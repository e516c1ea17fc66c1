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

/// When each node's body ran, on which thread, and what was loaded and kept: for viewers of Chrome's trace format. Safe from several
/// threads.
class RunProfile {
public:
    using Clock = std::chrono::steady_clock;

    explicit RunProfile(const Pipeline& pipeline) : pipeline_(pipeline) {}

    /// Something that takes time: an event from now until its end.
    class Span {
    public:
        /// @param profile   null: nothing is recorded
        /// @param category  run, take, digest, finish: a body of a node; load, keep: of its kept results. Outlives the profile
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

    /// JSON: {"traceEvents": [{"name", "cat", "ph": "X", "ts", "dur", "pid", "tid", "args": {"type", "frame"}}]}, times in microseconds
    /// since the profile was made, threads numbered from 1.
    std::string text() const;

private:
    struct Event {
        const char* category;
        std::size_t node;
        std::optional<int> frame;
        Clock::time_point start, end;
        int thread;
    };
    void add(const char* category, std::size_t node, std::optional<int> frame, Clock::time_point start);

    const Pipeline& pipeline_;
    const Clock::time_point start_ = Clock::now();
    mutable std::mutex mutex_;
    std::map<std::thread::id, int> threads_;
    std::vector<Event> events_;
};

}  // namespace fluidcarve
