#pragma once

#include "carve/base/limits.h"
#include "carve/base/values.h"
#include "carve/stream/stored.h"
#include "carve/time/spill_file.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

namespace fluidcarve {

/// The content of all frames of a sequence, such as volumes. It is held in memory up to a budget;
/// the rest goes to an unnamed file, which disappears when it is closed.
template <class T>
class FrameList {
public:
    explicit FrameList(const Limits& limits) : budget_(limits.memory), file_(limits.folder) {}

    std::size_t size() const { return entries_.size(); }
    /// @throws Failure if neither memory nor disk can hold it
    void add(const Ref<T>& frame) {
        if (const auto bytes = Stored<T>::bytes(*frame); held_ + bytes <= budget_) {
            held_ += bytes;
            entries_.push_back({frame, {}});
            return;
        }
        std::ostringstream stream;
        Stored<T>::write(*frame, stream);
        entries_.push_back({nullptr, file_.add(std::move(stream).str())});
    }
    /// Bit for bit what was added. May be called from many threads at once.
    Ref<T> at(std::size_t n) const {
        const auto& [held, place] = entries_.at(n);
        if (held) return held;
        std::istringstream stream(file_.at(place));
        return Stored<T>::read(stream);
    }

private:
    struct Entry {
        Ref<T> held;  ///< null: it is in the file
        SpillFile::Place place;
    };

    std::uint64_t budget_, held_ = 0;  ///< bytes
    SpillFile file_;
    std::vector<Entry> entries_;
};

/// A FrameList with the numbers of its frames.
template <class T>
class NumberedFrames {
public:
    /// Adds a frame. @param number  above those before
    /// @throws Failure if neither memory nor disk can hold it
    void add(const Ref<T>& frame, int number, const Limits& limits) {
        if (!frames_) frames_.emplace(limits);
        frames_->add(frame);
        numbers_.push_back(number);
    }

    const std::vector<int>& numbers() const { return numbers_; }  ///< rising
    std::size_t size() const { return numbers_.size(); }
    /// May be called from many threads at once.
    Ref<T> at(std::size_t place) const { return frames_->at(place); }

private:
    std::optional<FrameList<T>> frames_;
    std::vector<int> numbers_;
};

}  // namespace fluidcarve
