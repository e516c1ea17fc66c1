#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace fluidcarve {

/// How progress is printed.
enum class ProgressStyle {
    none,
    bar,     ///< one line on a terminal, redrawn
    json,    ///< one line of JSON per second
    plain,   ///< a line for each frame that is done with a pass, and every ten seconds, for logs
    openjd,  ///< one line with the percentage and one with the status per second, on stdout, as
             ///< Open Job Description requires
};

/// Prints the progress of a run and the time left to stderr. Thread-safe.
///
/// A step is one kind of work (a node's run per frame, or its finish) with its number of runs. The
/// time left is the sum over all steps of the mean time of a run so far, times the number of runs
/// left. Steps that have not begun count with their expected time; without one, with the mean of
/// the others. All times are shares of the wall time (WorkTimes).
///
/// The shown share never falls. If the time left turns out longer than estimated, the rest of the
/// bar stands for the rest of the work: a part of that work moves the bar by the same part of its
/// rest.
class Progress {
public:
    struct Step {
        std::string label;
        std::size_t runs = 0;
        std::optional<double> expected_s;  ///< of one run
    };
    /// @param say  tells the user a line of text; null: `say` tells nothing
    Progress(ProgressStyle style, std::size_t passes,
             std::function<void(const std::string& line)> say = nullptr);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Forgets all steps, since the run begins again. What was shown stays.
    void begin_again();
    std::size_t add(Step step);
    void begin_pass(std::size_t pass);
    /// To be called after each run of a step.
    /// @param seconds  time of the run
    /// @param frame  frame number, shown beside the bar
    void done(std::size_t step, double seconds, std::optional<int> frame);
    /// To be called during the run of a step with a single run.
    /// @param fraction  finished part, 0..1
    /// @param seconds  time so far
    void part(std::size_t step, double fraction, double seconds);

    /// To be called when a frame is done with a pass. @param frame  frame number
    void passed(int frame);

    /// Prints a line of text during the run; the bar makes room for it.
    void say(const std::string& line);

    double fraction();            ///< the share to show, 0..1
    double seconds_left() const;  ///< wall time

private:
    struct State {
        Step step;
        double done = 0;  ///< finished runs, with fractions
        double seconds = 0;
    };
    std::pair<double, double> spent_and_left() const;  ///< seconds
    double left() const;                               ///< seconds of wall time
    double advance();                                  ///< moves the share to show @return it
    void show(bool always);

    const ProgressStyle style_;
    const std::size_t passes_;
    const std::function<void(const std::string& line)> say_;
    std::size_t pass_ = 0;
    std::string current_;
    std::vector<State> steps_;
    double thought_ = 0;  ///< last estimate of the share of work done
    double shown_share_ = 0;
    mutable std::mutex mutex_;
    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    std::chrono::steady_clock::time_point shown_ =
        style_ == ProgressStyle::plain ? start_ : std::chrono::steady_clock::time_point();
    bool drawn_ = false;
    std::condition_variable_any ended_;
    std::jthread ticker_;  ///< of a plain style: shows that the run is alive
};

}  // namespace fluidcarve
