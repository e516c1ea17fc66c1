#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

enum class ProgressStyle {
    none,
    bar,   ///< one line on a terminal, redrawn
    json,  ///< a line of JSON a second
};

/// How far a run has come, on stderr, with the time left. Safe from several threads.
///
/// A step is one kind of work (a node per frame, or a node's finish) and its number of runs. The time left is the sum
/// over steps of what each run took so far times the runs to come; steps that have not begun count as the average.
class Progress {
public:
    struct Step {
        std::string label;
        std::size_t runs = 0;
    };
    Progress(ProgressStyle style, std::size_t passes) : style_(style), passes_(passes) {}
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    std::size_t add(Step step);
    void begin_pass(std::size_t pass);
    /// One run of the step is done. @param frame  shown beside the bar
    void done(std::size_t step, double seconds, std::optional<int> frame);
    /// A long single run has come so far, 0 to 1.
    void part(std::size_t step, double fraction, double seconds);

    double fraction() const;
    double seconds_left() const;

private:
    struct State {
        Step step;
        double done = 0;  ///< runs
        double seconds = 0;
    };
    std::pair<double, double> spent_and_left() const;  ///< seconds of work, summed over threads
    void show(bool always);

    const ProgressStyle style_;
    const std::size_t passes_;
    std::size_t pass_ = 0;
    std::string current_;
    std::vector<State> steps_;
    mutable std::mutex mutex_;
    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    std::chrono::steady_clock::time_point shown_{};
    bool drawn_ = false;
};

}  // namespace fluidcarve
