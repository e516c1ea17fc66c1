#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace fluidcarve {

/// What came of a call in a process of its own.
struct Confined {
    enum class End { returned, threw, crashed, too_slow };
    End end = End::crashed;
    std::string text;  ///< what it returned, or the message of what it threw; of a crash, the signal
};

/// Calls in a child process with limits, so that a hostile file can take down or hang that one only. What the call
/// prints is dropped. Call it before the program has other threads.
/// @param memory   bytes of address space
/// @param seconds  until the child is killed
Confined call_confined(const std::function<std::string()>& call, std::uint64_t memory, double seconds);

}  // namespace fluidcarve
