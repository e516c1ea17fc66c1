#pragma once

#include <atomic>
#include <thread>

namespace fluidcarve {

/// While it lives, Ctrl-C (SIGINT, SIGTERM) asks the run to stop; if it has not within 0.8 s, or at the second
/// signal, the process removes what it was writing and leaves with exit code 130. Make it before any other thread.
class Interrupt {
public:
    Interrupt();
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    bool asked() const { return asked_; }

private:
    void watch();
    std::atomic<bool> asked_{false};
    int signals_ = -1;
    int ended_ = -1;
    std::thread thread_;
};

}  // namespace fluidcarve
