#pragma once

#include "carve/base/limits.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace fluidcarve {

/// Stores the entries of a sequence: 16-bit numbers or floats, the same number for each frame,
/// initially 0. The store is held in memory or, if it exceeds the limits, in a mapped file that
/// disappears with the process.
template <class Entry>
class FrameStoreOf {
public:
    /// @param count    number of frames
    /// @param entries  per frame
    /// @throws Failure if neither memory nor disk can hold the frames
    FrameStoreOf(std::size_t count, std::size_t entries, const Limits& limits = {});

    std::size_t count() const { return count_; }
    std::span<Entry> entries(std::size_t n) { return {data_.get() + n * entries_, entries_}; }
    std::span<const Entry> entries(std::size_t n) const {
        return {data_.get() + n * entries_, entries_};
    }

private:
    struct Release {
        std::size_t mapped;  ///< bytes of the mapping; 0: heap memory
        void operator()(Entry* data) const;
    };
    std::size_t count_, entries_;
    std::unique_ptr<Entry, Release> data_;
};

using FrameStore = FrameStoreOf<std::uint16_t>;
using FloatFrameStore = FrameStoreOf<float>;

}  // namespace fluidcarve
