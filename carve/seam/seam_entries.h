#pragma once

#include "carve/base/frame_store.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// One seam's entries for all columns of a sequence, in memory or in a mapped file that disappears
/// with the process. Copies share their entries. Entries in memory are copied on write; entries in
/// a file stay shared.
class SeamEntries {
public:
    SeamEntries() = default;
    SeamEntries(std::vector<std::uint16_t> entries)
        : held_(std::make_shared<std::vector<std::uint16_t>>(std::move(entries))) {}
    SeamEntries(std::initializer_list<std::uint16_t> entries)
        : SeamEntries(std::vector<std::uint16_t>(entries)) {}
    /// Copies entries to a mapped file in a folder.
    /// @throws Failure if the disk can't hold it
    static SeamEntries in_file(std::span<const std::uint16_t> entries, const std::string& folder) {
        SeamEntries out;
        out.file_ = std::make_shared<FrameStore>(1, entries.size(), Limits{0, folder});
        std::ranges::copy(entries, out.file_->entries(0).begin());
        return out;
    }

    /// The entries of a seam that is the same in all frames.
    static SeamEntries repeated(std::span<const std::uint16_t> frame, std::size_t frames) {
        std::vector<std::uint16_t> out;
        out.reserve(frame.size() * frames);
        for (std::size_t t = 0; t < frames; ++t) out.insert(out.end(), frame.begin(), frame.end());
        return out;
    }

    bool on_disk() const { return file_ != nullptr; }
    std::span<const std::uint16_t> all() const {
        if (file_) return std::as_const(*file_).entries(0);
        return held_ ? std::span<const std::uint16_t>(*held_) : std::span<const std::uint16_t>();
    }
    std::span<std::uint16_t> all() {
        if (file_) return file_->entries(0);
        if (!held_) return {};
        if (held_.use_count() > 1) held_ = std::make_shared<std::vector<std::uint16_t>>(*held_);
        return *held_;
    }
    operator std::span<const std::uint16_t>() const { return all(); }

    std::size_t size() const { return all().size(); }
    auto begin() const { return all().begin(); }
    auto end() const { return all().end(); }
    std::uint16_t operator[](std::size_t column) const { return all()[column]; }
    bool operator==(const SeamEntries& other) const {
        return std::ranges::equal(all(), other.all());
    }

private:
    std::shared_ptr<std::vector<std::uint16_t>> held_;
    std::shared_ptr<FrameStore> file_;
};

}  // namespace fluidcarve
