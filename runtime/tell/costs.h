#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace fluidcarve {

/// The conditions that a measured time depends on, as far as known. 0: unknown or irrelevant.
struct CostSetting {
    /// Bodies that could work at once; for a body that is called once: threads.
    double abreast = 1;
    double cores = 1;               ///< cores that a body called once kept busy
    std::uint64_t input_bytes = 0;  ///< memory of a frame, as the readers estimate it
    std::size_t gathered = 0;       ///< frames that a gathering node had consumed
    std::size_t items = 0;          ///< items of a growing result (Growth) that were found
    std::size_t all_items = 0;      ///< 100 % of a count of items (ItemCount::all_items)
};

/// A measured time, with its setting.
struct WorkTime {
    double seconds = 0;  ///< share of the run's wall time (WorkTimes)
    CostSetting at;
};

/// The time in another setting. It is proportional to bytes, frames and items, and inversely
/// proportional to the number of bodies at work; for a body that is called once, only as far as it
/// kept several cores busy (Amdahl's law).
double seconds_in(const WorkTime& cost, const CostSetting& now);

/// The kinds of work of a node.
enum class Work : std::size_t {
    frame,    ///< to compute a frame, and to keep it
    consume,  ///< for a gathering node, to consume a frame of its inputs
    load,     ///< to load a cached result
    once,     ///< to finish, or to run once
};
constexpr std::size_t work_kinds = 4;

/// The costs of one call of each kind; nothing: unknown.
struct NodeCost {
    std::array<std::optional<WorkTime>, work_kinds> by_work;
    std::uint64_t bytes = 0;           ///< largest result in memory; 0: unknown
    std::uint64_t bytes_of_input = 0;  ///< CostSetting::input_bytes of `bytes`

    std::optional<WorkTime>& operator[](Work work) {
        return by_work[static_cast<std::size_t>(work)];
    }
    const std::optional<WorkTime>& operator[](Work work) const {
        return by_work[static_cast<std::size_t>(work)];
    }
};

/// Measures the time of each kind of work. While k bodies work at once, each counts for a k-th of
/// the time: so all times add up to the wall time in which any body worked. Thread-safe.
class WorkTimes {
public:
    /// @param expected  one per node, in the setting of this run
    explicit WorkTimes(std::vector<NodeCost> expected)
        : expected_(std::move(expected)), sums_(expected_.size()) {}

    /// Seconds that a call of this kind is expected to take; nothing: unknown.
    std::optional<double> expected(std::size_t node, Work work) const;

    /// A body at work, from the construction to `end` or the destruction.
    class Span {
    public:
        explicit Span(WorkTimes& costs);
        ~Span() { end(); }
        Span(const Span&) = delete;
        Span& operator=(const Span&) = delete;

        /// Ends the span; does nothing if it has ended.
        /// @return its share of the wall time so far, seconds
        double end();
        /// Cores that the process kept busy, once the span has ended.
        double cores() const { return cores_; }

    private:
        WorkTimes& costs_;
        const double start_;
        const std::chrono::steady_clock::time_point wall_start_ = std::chrono::steady_clock::now();
        const double cpu_start_;
        double share_ = 0, cores_ = 1;
        bool open_ = true;
    };

    /// Adds a call.
    /// @param seconds  its share of the wall time; of several calls the mean counts, and the latest
    ///   setting
    void add(std::size_t node, Work work, double seconds, const CostSetting& at);
    /// The mean costs of a node's calls; `bytes` is not measured here.
    NodeCost mean(std::size_t node) const;

private:
    struct Sum {
        double seconds = 0;
        std::size_t calls = 0;
        CostSetting at;
    };
    double enter();
    double leave();
    void advance();

    const std::vector<NodeCost> expected_;
    mutable std::mutex mutex_;
    std::size_t at_work_ = 0;  ///< open spans
    /// Sum of the wall time, each moment divided by the number of open spans; seconds.
    double shared_ = 0;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
    std::vector<std::array<Sum, work_kinds>> sums_;
};

}  // namespace fluidcarve
