#include "runtime/run/interrupt.h"

#include <catch2/catch.hpp>

#include <pthread.h>
#include <atomic>
#include <chrono>
#include <csignal>
#include <thread>

using namespace fluidcarve;

TEST_CASE("a signal that meets a thread from before asks the run to stop, too") {
    using namespace std::chrono_literals;
    std::atomic<bool> over = false;
    std::thread before([&] {
        while (!over) std::this_thread::sleep_for(1ms);
    });
    {
        const Interrupt interrupt({}, 600000);
        CHECK_FALSE(interrupt.asked());
        pthread_kill(before.native_handle(), SIGINT);
        for (int waited = 0; !interrupt.asked() && waited < 5000; ++waited)
            std::this_thread::sleep_for(1ms);
        CHECK(interrupt.asked());
    }
    over = true;
    before.join();
}
