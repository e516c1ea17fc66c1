#pragma once

#include "carve/base/descriptor.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace fluidcarve {

/// Blocks of bytes in an unnamed file, which is created when the first block is added.
class SpillFile {
public:
    struct Place {
        std::uint64_t begin = 0;
        std::size_t size = 0;
    };

    /// @param folder  for the file; created if missing
    explicit SpillFile(std::string folder) : folder_(std::move(folder)) {}

    /// @throws Failure if there is no room
    Place add(std::string_view bytes);
    /// What was added. May be called from many threads at once.
    std::string at(const Place& place) const;

private:
    std::string folder_;
    std::uint64_t end_ = 0;
    Descriptor file_{-1};
};

}  // namespace fluidcarve
