#pragma once

#include <cstdint>
#include <optional>

namespace fluidcarve {

/// Resources that a run needs.
struct RunResources {
    int cores = 0;
    std::uint64_t memory = 0;         ///< bytes; 0: unknown
    std::uint64_t disk = 0;           ///< bytes that it writes, in the work folder and as outputs;
                                      ///< 0: unknown
    std::optional<double> seconds{};  ///< wall time; nothing: a node of it was never measured
};

}  // namespace fluidcarve
