#include "runtime/flow/out_of_memory.h"

#include "carve/base/words.h"

#include <fmt/format.h>

#include <sys/resource.h>
#include <unistd.h>
#include <algorithm>
#include <fstream>
#include <limits>
#include <string_view>

namespace fluidcarve {

MemoryNow memory_now() {
    const auto page = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
    std::uint64_t pages = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> pages >> resident;
    MemoryNow out{resident * page, std::numeric_limits<std::uint64_t>::max()};
    std::ifstream machine("/proc/meminfo");
    std::string line;
    while (std::getline(machine, line))
        if (constexpr std::string_view name = "MemAvailable:"; line.starts_with(name))
            out.free = std::stoull(line.substr(name.size())) * 1024;
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        out.free =
            std::min(out.free, limit.rlim_cur > pages * page ? limit.rlim_cur - pages * page : 0);
    return out;
}

std::string out_of_memory(Phase phase, std::size_t frames, const MemoryNow& memory) {
    const auto doing = phase == Phase::digest    ? "while it took what it needs of the frame"
                       : phase == Phase::consume ? "while it gathered the frame"
                       : phase == Phase::finish  ? "while it worked on all that it had gathered"
                                                 : "while it ran";
    const bool crowded = frames > 1 && memory.held > memory.free;
    return fmt::format(
        "out of memory {}: {}", doing,
        crowded ? fmt::format("{} frames were in flight; try a smaller --in-flight", frames)
                : fmt::format("it wanted more in one piece than is free ({} held by the run, {} "
                              "free); give it a smaller volume or a coarser lattice, or the run "
                              "more memory",
                              size_text(memory.held), size_text(memory.free)));
}

}  // namespace fluidcarve
