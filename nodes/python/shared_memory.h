#pragma once

#include <cstddef>
#include <cstdint>

namespace fluidcarve {

/// Memory shared with another process. It has no name, and disappears with the last process that
/// holds it. It grows, and never shrinks.
class SharedMemory {
public:
    /// @throws Failure if the system gives none
    SharedMemory();
    ~SharedMemory();
    SharedMemory(const SharedMemory&) = delete;
    SharedMemory& operator=(const SharedMemory&) = delete;

    /// The descriptor by which another process maps the memory.
    int descriptor() const { return file_; }
    std::uint64_t size() const { return size_; }
    /// The memory, grown to at least `bytes` bytes. @throws Failure if the system gives no more
    std::byte* grown(std::uint64_t bytes);
    /// The memory as the other process left it. @throws Failure if it holds fewer bytes
    const std::byte* seen(std::uint64_t bytes);

private:
    void map(std::uint64_t bytes);

    int file_ = -1;
    std::byte* data_ = nullptr;
    std::uint64_t size_ = 0;  ///< bytes that are mapped
};

}  // namespace fluidcarve
