#pragma once

#include "carve/base/values.h"
#include "carve/volume/volume.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// Volumes of many frames: in memory as far as a budget allows, else in a file of the work folder
/// that has no name, so that nothing is left of it.
class VolumeStore {
public:
    /// @param memory_budget  bytes
    /// @param folder         for the file; created if missing
    VolumeStore(std::uint64_t memory_budget, std::string folder)
        : budget_(memory_budget), folder_(std::move(folder)) {}
    ~VolumeStore();
    VolumeStore(const VolumeStore&) = delete;
    VolumeStore& operator=(const VolumeStore&) = delete;

    std::size_t size() const { return entries_.size(); }
    /// @throws Failure if neither memory nor disk can hold it
    void add(const Ref<Volume>& volume);
    /// Bit for bit what was added. May be called from many threads at once.
    Ref<Volume> at(std::size_t n) const;

private:
    struct Entry {
        Ref<Volume> held;                  ///< null: it is in the file
        std::int64_t begin = 0, size = 0;  ///< bytes in the file
    };

    std::uint64_t budget_;
    std::string folder_;
    std::uint64_t held_ = 0;  ///< bytes
    std::int64_t end_ = 0;    ///< of the file
    int file_ = -1;
    std::vector<Entry> entries_;
};

}  // namespace fluidcarve
