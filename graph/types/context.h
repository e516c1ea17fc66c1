#pragma once

#include "carve/base/limits.h"
#include "formats/file/provenance.h"
#include "graph/types/payload.h"

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fluidcarve {

/// A node body's connection to its run: the frame, the limits, warnings, report and progress.
/// A default-constructed Context lets a test call a body alone: one frame, number 1, and messages
/// go nowhere.
class Context {
public:
    /// The run's side of the connection. Implementations must be thread-safe.
    struct Host {
        virtual ~Host() = default;
        virtual bool cancelled() const { return false; }
        virtual void warn(const std::string& /*message*/) {}
        virtual void warn_at_once(const std::string& message) { warn(message); }
        virtual void report(const std::string& /*section*/,
                            const nlohmann::ordered_json& /*entry*/) {}
        virtual void tell(const std::string& /*line*/) {}
        virtual void progress(double /*fraction*/) {}
        virtual void checkpoint(const Payload& /*result*/) {}
        virtual Provenance provenance() const { return {}; }
    };

    Context();
    Context(Host& host, const std::vector<int>& frames) : host_(&host), frames_(&frames) {}

    /// Number of the frame, and its index in `frames()`. In `finish` and in static nodes: those of
    /// the first frame.
    int frame() const { return t_ < frames_->size() ? (*frames_)[t_] : 1; }
    std::size_t t() const { return t_; }
    /// Frame numbers of the whole sequence, even if only a part of it is delivered.
    const std::vector<int>& frames() const { return *frames_; }

    /// Whether the body runs for one frame of many; false in `finish` and in nodes that run once.
    bool per_frame() const { return per_frame_; }
    /// The frame in a report: its number, or "all".
    std::string frame_name() const { return per_frame_ ? std::to_string(frame()) : "all"; }

    /// Whether the run reads this output. Bodies may leave unread outputs empty.
    bool wants(std::string_view output) const { return !wants_ || wants_(output); }

    bool cancelled() const { return host_->cancelled(); }
    /// Throws Cancelled once the run is being stopped. Long bodies call it a few times per second.
    void check_cancelled() const;
    /// Reports how much of the work of `finish` is done, 0 to 1. Results of an earlier run
    /// (`resume`) do not count.
    void progress(double fraction) const { host_->progress(fraction); }
    /// Saves the finished part of a growing result (Growth), so that it is not lost if the run is
    /// killed.
    void checkpoint(const Payload& result) const { host_->checkpoint(result); }
    /// Shows a warning at the end of the run and adds it to the report, once per node and text.
    void warn(const std::string& message) const { host_->warn(message); }
    /// The same, but shown at once: for faults that make long work ahead useless.
    void warn_at_once(const std::string& message) const { host_->warn_at_once(message); }
    /// Adds an entry for this node to a section of the report, such as `seams`.
    void report(const std::string& section, const nlohmann::ordered_json& entry) const {
        host_->report(section, entry);
    }

    /// Shows a line at the end of the run, behind the node's name, unless the run is quiet. Only
    /// `conclude` may call it.
    void tell(const std::string& line) const { host_->tell(line); }
    /// The provenance that a writer states in its files, in place of that of a file that was read.
    /// Empty: none.
    Provenance provenance() const { return host_->provenance(); }

    /// What one node may hold in memory for the whole sequence, and the work folder, where it
    /// holds the rest in files.
    const Limits& limits() const { return limits_; }

    Context& at(std::size_t t) {
        t_ = t;
        per_frame_ = true;
        return *this;
    }
    Context& wanting(std::function<bool(std::string_view)> wants) {
        wants_ = std::move(wants);
        return *this;
    }
    Context& limits(Limits limits) {
        limits_ = std::move(limits);
        return *this;
    }

private:
    Host* host_;
    const std::vector<int>* frames_;
    std::size_t t_ = 0;
    bool per_frame_ = false;
    std::function<bool(std::string_view)> wants_;
    Limits limits_;
};

}  // namespace fluidcarve
