#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// How progress is printed.
enum class ProgressStyle {
    none,
    bar,   ///< one line on a terminal, redrawn
    json,  ///< one line of JSON per second
};

/// Prints the progress of a run and the time left to stderr. Thread-safe.
///
/// A step is one kind of work (a node's run per frame, or its finish) with its number of runs. The time left is the sum over all steps
/// of the mean time of a run so far, times the number of runs left. Steps that have not begun count with the mean of the others.
class Progress {
public:
    struct Step {
        std::string label;
        std::size_t runs = 0;
    };
    /// @param say  tells the user a line of text; null: `say` tells nothing
    Progress(ProgressStyle style, std::size_t passes, std::function<void(const std::string& line)> say = nullptr)
        : style_(style), passes_(passes), say_(std::move(say)) {}
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    std::size_t add(Step step);
    void begin_pass(std::size_t pass);
    /// To be called after each run of a step. @param seconds  time of the run @param frame  frame number, shown beside the bar
    void done(std::size_t step, double seconds, std::optional<int> frame);
    /// To be called during the run of a step with a single run. @param fraction  finished part, 0..1 @param seconds  time so far
    void part(std::size_t step, double fraction, double seconds);

    /// Tells a line of text while the run goes on; the bar makes way for it.
    void say(const std::string& line);

    double fraction() const;
    double seconds_left() const;

private:
    struct State {
        Step step;
        double done = 0;  ///< finished runs, with fractions
        double seconds = 0;
    };
    std::pair<double, double> spent_and_left() const;  ///< seconds of work, summed over all threads
    void show(bool always);

    const ProgressStyle style_;
    const std::size_t passes_;
    const std::function<void(const std::string& line)> say_;
    std::size_t pass_ = 0;
    std::string current_;
    std::vector<State> steps_;
    mutable std::mutex mutex_;
    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    std::chrono::steady_clock::time_point shown_{};
    bool drawn_ = false;
};

}  // namespace fluidcarve
