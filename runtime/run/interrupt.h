#pragma once

#include <atomic>
#include <string>
#include <thread>

namespace fluidcarve {

/// Handles SIGINT (Ctrl-C), SIGTERM and, unless it is ignored (nohup), SIGHUP during its lifetime.
/// The first signal asks the run to stop. After a time of grace, or at the second signal, the
/// process removes unfinished files and exits with code 130. Writing into a closed pipe or beyond
/// a file size limit fails with an error in place of a signal. Only one may exist at a time.
class Interrupt {
public:
    /// @param last_words  printed to stderr by a process that exits at once; empty: nothing
    /// @param grace_ms    milliseconds that the run has to stop by itself
    explicit Interrupt(std::string last_words, int grace_ms = 800);
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    bool asked() const { return asked_; }

private:
    void watch();
    static void forward(int number);
    const std::string last_words_;
    const int grace_ms_;
    std::atomic<bool> asked_{false}, ended_{false};
    std::thread thread_;
};

/// The last words of a run: interrupted_text, unless it is quiet.
/// @param kept  whether the work folder keeps what was computed
std::string last_words(bool quiet, bool kept);

}  // namespace fluidcarve
