#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace fluidcarve {

/// Memory of the process and of the machine, in bytes.
struct MemoryNow {
    std::uint64_t held = 0;  ///< what the process has in memory
    /// What it may still take: free in the machine, and within the limit of the process.
    std::uint64_t free = 0;
};
MemoryNow memory_now();

/// The message of a body that got no memory: what it was doing, and what helps. Fewer frames in
/// flight help only if several were in memory, and if they took most of what there was; else a
/// single piece was too large.
/// @param what    the body: run, digest, take or finish (RunProfile)
/// @param frames  frames that were in flight
std::string out_of_memory(std::string_view what, std::size_t frames, const MemoryNow& memory);

}  // namespace fluidcarve
