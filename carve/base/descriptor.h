#pragma once

#include <cstddef>
#include <cstdint>

namespace fluidcarve {

/// An open file of the system, closed at the end of its scope.
struct Descriptor {
    explicit Descriptor(int number) : number(number) {}
    ~Descriptor();
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;

    int number;  ///< below 0: no file is open
};

/// Reads `size` bytes at `offset`, also if signals interrupt it.
/// @return false if there are fewer; where the system failed, `errno` tells why
bool read_at(int file, std::uint64_t offset, void* into, std::size_t size);
/// Writes `size` bytes at `offset`, also if signals interrupt it.
/// @return false if the system failed; `errno` tells why
bool write_at(int file, std::uint64_t offset, const void* from, std::size_t size);

}  // namespace fluidcarve
