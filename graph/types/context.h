#pragma once

#include "graph/types/payload.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// What a node body may ask of the run that it is part of, and tell it.
/// A default-made Context stands alone: one frame, 1, nothing listens; so that a test can call a body.
class Context {
public:
    /// The run's side. All calls may come from several threads at once.
    struct Host {
        virtual ~Host() = default;
        virtual bool cancelled() const { return false; }
        virtual void warn(const std::string& /*message*/) {}
        virtual void report(const std::string& /*section*/, const nlohmann::ordered_json& /*entry*/) {}
        virtual void progress(double /*fraction*/) {}
        virtual void hold(const Payload& /*result*/) {}
    };

    Context();
    Context(Host& host, const std::vector<int>& frames) : host_(&host), frames_(&frames) {}

    /// The frame's number, and its place in the sequence. In `finish` and in static nodes: of the first frame.
    int frame() const { return place_ < frames_->size() ? (*frames_)[place_] : 1; }
    std::size_t place() const { return place_; }
    /// The whole sequence, whatever part of it is delivered.
    const std::vector<int>& frames() const { return *frames_; }

    /// Whether the body runs for one frame of many; false in `finish` and in nodes that run once.
    bool per_frame() const { return per_frame_; }

    /// Whether anyone reads this output now; bodies may leave other outputs empty.
    bool wants(std::string_view output) const { return !wants_ || wants_(output); }

    bool cancelled() const { return host_->cancelled(); }
    /// Throws Cancelled once the run is being stopped; long bodies call it a few times a second.
    void check_cancelled() const;
    /// How far `finish` has come, 0 to 1.
    void progress(double fraction) const { host_->progress(fraction); }
    /// What of a growing result (Growth) is there already, so that a run that is killed need not find it again.
    void hold(const Payload& result) const { host_->hold(result); }
    /// Shown at the end and kept in the report, once per node and text.
    void warn(const std::string& message) const { host_->warn(message); }
    /// An entry for this node in a section of the report (`seams`).
    void report(const std::string& section, const nlohmann::ordered_json& entry) const { host_->report(section, entry); }

    /// Bytes that one node may hold for the whole sequence before it moves to files below `work_folder`.
    std::uint64_t memory_budget() const { return memory_budget_; }
    const std::string& work_folder() const { return work_folder_; }

    Context& at(std::size_t place) {
        place_ = place;
        per_frame_ = true;
        return *this;
    }
    Context& wanting(std::function<bool(std::string_view)> wants) {
        wants_ = std::move(wants);
        return *this;
    }
    Context& limits(std::uint64_t memory_budget, std::string work_folder) {
        memory_budget_ = memory_budget;
        work_folder_ = std::move(work_folder);
        return *this;
    }

private:
    Host* host_;
    const std::vector<int>* frames_;
    std::size_t place_ = 0;
    bool per_frame_ = false;
    std::function<bool(std::string_view)> wants_;
    std::uint64_t memory_budget_ = ~std::uint64_t{0};
    std::string work_folder_ = ".fluidcarve";
};

}  // namespace fluidcarve
