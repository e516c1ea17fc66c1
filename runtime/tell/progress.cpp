#include "runtime/tell/progress.h"

#include "graph/text/json_text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace fluidcarve {
namespace {

/// Removes the bar from its line.
constexpr auto clear_line = "\r\x1b[K";

std::string clock_text(double seconds) {
    const auto whole = static_cast<long>(std::ceil(std::min(seconds, 1e9)));
    if (whole >= 3600)
        return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
    return fmt::format("{:02}:{:02}", whole / 60, whole % 60);
}

void put(const std::string& text) {
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

/// Time between two lines of a style.
std::chrono::milliseconds pause_of(ProgressStyle style) {
    if (style == ProgressStyle::bar) return std::chrono::milliseconds(100);
    return std::chrono::milliseconds(style == ProgressStyle::plain ? 10000 : 1000);
}

}  // namespace

Progress::Progress(ProgressStyle style, std::size_t passes,
                   std::function<void(const std::string& line)> say)
    : style_(style), passes_(passes), say_(std::move(say)) {
    if (style_ != ProgressStyle::plain) return;
    ticker_ = std::jthread([this](const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        while (!stop.stop_requested()) {
            ended_.wait_for(lock, stop, std::chrono::seconds(1), [] { return false; });
            if (!stop.stop_requested()) show(false);
        }
    });
}

Progress::~Progress() {
    if (ticker_.joinable()) {
        ticker_.request_stop();
        ticker_.join();
    }
    if (style_ != ProgressStyle::none && style_ != ProgressStyle::plain) show(true);
    if (drawn_) put("\n");
}

void Progress::begin_again() {
    const std::lock_guard lock(mutex_);
    steps_.clear();
    thought_ = 0;
}

std::size_t Progress::add(Step step) {
    const std::lock_guard lock(mutex_);
    steps_.push_back({std::move(step), 0, 0});
    return steps_.size() - 1;
}

void Progress::begin_pass(std::size_t pass) {
    const std::lock_guard lock(mutex_);
    pass_ = pass;
}

void Progress::done(std::size_t step, double seconds, std::optional<int> frame) {
    const std::lock_guard lock(mutex_);
    auto& state = steps_[step];
    state.done = std::min<double>(std::floor(state.done) + 1, static_cast<double>(state.step.runs));
    // `part` has already added the time of a single run.
    state.seconds = state.step.runs == 1 ? seconds : state.seconds + seconds;
    current_ = frame ? fmt::format("{} {}", state.step.label, *frame) : state.step.label;
    show(false);
}

void Progress::part(std::size_t step, double fraction, double seconds) {
    const std::lock_guard lock(mutex_);
    auto& state = steps_[step];
    state.done = std::clamp(fraction, 0.0, 0.999);
    state.seconds = seconds;
    current_ = state.step.label;
    show(false);
}

std::pair<double, double> Progress::spent_and_left() const {
    double spent = 0;
    double runs = 0;
    for (const auto& state : steps_) {
        spent += state.seconds;
        runs += state.done;
    }
    // An expectation counts as much as a tenth of a run.
    constexpr double weight = 0.1;
    const double average = runs > 0 ? spent / runs : 0;
    double left = 0;
    for (const auto& state : steps_) {
        const auto& expected = state.step.expected_s;
        const double one_run = expected
                                   ? (state.seconds + weight * *expected) / (state.done + weight)
                               : state.done > 0 ? state.seconds / state.done
                                                : average;
        left += (static_cast<double>(state.step.runs) - state.done) * one_run;
    }
    return {spent, left};
}

void Progress::passed(int frame) {
    if (style_ != ProgressStyle::plain) return;
    const std::lock_guard lock(mutex_);
    current_ = fmt::format("frame {}", frame);
    show(true);
}

void Progress::say(const std::string& line) {
    const std::lock_guard lock(mutex_);
    if (!say_) return;
    if (std::exchange(drawn_, false)) put(clear_line);
    say_(line);
}

double Progress::left() const {
    const auto [spent, left] = spent_and_left();
    const double wall =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    return spent > 0 ? left * wall / spent : left;
}

double Progress::advance() {
    const auto [spent, left] = spent_and_left();
    const double now = spent + left > 0 ? spent / (spent + left) : 0;
    if (now > thought_) shown_share_ += (1 - shown_share_) * (now - thought_) / (1 - thought_);
    thought_ = now;
    return shown_share_;
}

double Progress::fraction() {
    const std::lock_guard lock(mutex_);
    return advance();
}

double Progress::seconds_left() const {
    const std::lock_guard lock(mutex_);
    return left();
}

void Progress::show(bool always) {
    const auto now = std::chrono::steady_clock::now();
    if (style_ == ProgressStyle::none || (!always && now - shown_ < pause_of(style_))) return;
    shown_ = now;
    const double wall = std::chrono::duration<double>(now - start_).count();
    const double fraction = advance(), seconds_left = left();
    if (style_ == ProgressStyle::json) {
        put(json_text(nlohmann::ordered_json{{"event", "progress"},
                                             {"pass", pass_ + 1},
                                             {"passes", passes_},
                                             {"fraction", std::round(fraction * 1000) / 1000},
                                             {"elapsed_s", std::round(wall * 10) / 10},
                                             {"left_s", std::round(seconds_left * 10) / 10},
                                             {"at", current_}}) +
            "\n");
        return;
    }
    const auto status = fmt::format("pass {}/{}, {} left: {}", pass_ + 1, passes_,
                                    clock_text(seconds_left), current_);
    if (style_ == ProgressStyle::plain)
        return put(fmt::format("{:3.0f} %, {}\n", fraction * 100, status));
    if (style_ == ProgressStyle::openjd) {
        // Not fmt::print: it throws if stdout is a file on a full disk.
        std::fputs(
            fmt::format("openjd_progress: {:.1f}\nopenjd_status: {}\n", fraction * 100, status)
                .c_str(),
            stdout);
        std::fflush(stdout);
        return;
    }
    constexpr int width = 24;
    const int filled = static_cast<int>(fraction * width);
    put(fmt::format("{}[{:=<{}}{:>{}}] {:3.0f} %  pass {}/{}  {} left  {}", clear_line, "", filled,
                    "", width - filled, fraction * 100, pass_ + 1, passes_,
                    clock_text(seconds_left), current_));
    drawn_ = true;
}

}  // namespace fluidcarve
