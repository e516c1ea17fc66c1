#pragma once

#include "runtime/flow/phase.h"

#include <cstddef>
#include <cstdint>
#include <string>

namespace fluidcarve {

/// Memory of the process and of the machine, in bytes.
struct MemoryNow {
    std::uint64_t held = 0;  ///< what the process has in memory
    /// What it may still allocate: free in the machine, and within the limit of the process.
    std::uint64_t free = 0;
};
MemoryNow memory_now();

/// The message for a body that ran out of memory: what it was doing, and the remedy. Fewer frames
/// in flight help only if several were in memory, and took most of it; else a single allocation
/// was too large.
/// @param frames  frames that were in flight
std::string out_of_memory(Phase phase, std::size_t frames, const MemoryNow& memory);

}  // namespace fluidcarve
