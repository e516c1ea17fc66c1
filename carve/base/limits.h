#pragma once

#include <cstdint>
#include <string>

namespace fluidcarve {

/// The memory that a computation may use, and the folder for the rest of its data.
struct Limits {
    /// Bytes in memory for a whole sequence; data beyond that goes to files in `folder`
    std::uint64_t memory = ~std::uint64_t{0};
    std::string folder = ".fluidcarve";  ///< created when needed; its files are unnamed and
                                         ///< disappear with the process
};

/// Half of the machine's memory, in bytes.
std::uint64_t half_of_memory();

}  // namespace fluidcarve
