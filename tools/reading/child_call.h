#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace fluidcarve {

/// Outcome of a call in a child process.
struct ChildResult {
    enum class End { returned, threw, crashed, too_slow };
    End end = End::crashed;
    std::string text;  ///< the returned text, the exception's message, or the name of the signal
};

/// Calls a function in a child process with limits, so that a hostile file can't crash or hang the
/// program. Output of the call to stdout and stderr is discarded. Must be called before the program
/// starts other threads.
/// @param memory   limit of the address space, bytes
/// @param seconds  time after which the child is killed
ChildResult call_in_child(const std::function<std::string()>& call, std::uint64_t memory,
                          double seconds);

}  // namespace fluidcarve
