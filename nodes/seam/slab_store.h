#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace fluidcarve {

/// 16-bit entries for a sequence, one slab per frame, zero at first: in memory, or, where that would exceed the budget,
/// in a mapped file that vanishes with the process.
class SlabStore {
public:
    /// @param count          slabs
    /// @param entries        per slab
    /// @param memory_budget  bytes that may be held in memory
    /// @param folder         where the file goes; made if it is not there
    /// @throws Failure if neither memory nor disk can hold the slabs
    SlabStore(std::size_t count, std::size_t entries, std::uint64_t memory_budget, const std::string& folder);
    ~SlabStore();
    SlabStore(const SlabStore&) = delete;
    SlabStore& operator=(const SlabStore&) = delete;

    std::size_t count() const { return count_; }
    bool on_disk() const { return on_disk_; }
    std::span<std::uint16_t> slab(std::size_t n) { return {data_ + n * entries_, entries_}; }
    std::span<const std::uint16_t> slab(std::size_t n) const { return {data_ + n * entries_, entries_}; }

private:
    std::size_t count_, entries_, bytes_;
    bool on_disk_;
    std::uint16_t* data_ = nullptr;
};

}  // namespace fluidcarve
