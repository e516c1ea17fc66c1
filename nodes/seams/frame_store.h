#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace fluidcarve {

/// Stores 16-bit entries of a sequence, equally many for each frame, initially 0. They are kept in memory or, over the budget, in a mapped file that
/// disappears with the process.
class FrameStore {
public:
    /// @param count          number of frames
    /// @param entries        per frame
    /// @param memory_budget  bytes that may be held in memory
    /// @param folder         for the file; created if missing
    /// @throws Failure if neither memory nor disk can hold the frames
    FrameStore(std::size_t count, std::size_t entries, std::uint64_t memory_budget, const std::string& folder);

    std::size_t count() const { return count_; }
    bool on_disk() const { return on_disk_; }
    std::span<std::uint16_t> entries(std::size_t n) { return {data_.get() + n * entries_, entries_}; }
    std::span<const std::uint16_t> entries(std::size_t n) const { return {data_.get() + n * entries_, entries_}; }

private:
    struct Unmap {
        std::size_t bytes;
        void operator()(std::uint16_t* data) const;
    };
    std::size_t count_, entries_;
    bool on_disk_;
    std::unique_ptr<std::uint16_t, Unmap> data_;
};

}  // namespace fluidcarve
