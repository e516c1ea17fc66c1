#pragma once

#include <cstdint>
#include <string>

namespace fluidcarve {

/// What work may take of the machine.
struct Limits {
    /// Bytes held for a whole sequence; what is beyond goes to files in `folder`
    std::uint64_t memory = ~std::uint64_t{0};
    std::string folder = ".fluidcarve";  ///< made when it is needed; the files in it have no names,
                                         ///< and leave nothing behind
};

/// Half of the machine's memory, in bytes.
std::uint64_t half_of_memory();

}  // namespace fluidcarve
