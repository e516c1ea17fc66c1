#pragma once

#include "nodes/seam/slab_store.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// One seam's entries for all columns of a sequence: in memory, or in a mapped file that vanishes with the process.
/// Copies of those in a file share it.
class SeamEntries {
public:
    SeamEntries() = default;
    SeamEntries(std::vector<std::uint16_t> entries) : held_(std::move(entries)) {}
    SeamEntries(std::initializer_list<std::uint16_t> entries) : held_(entries) {}
    /// In a file in the folder. @throws Failure if the disk can't hold it
    static SeamEntries in_file(std::span<const std::uint16_t> entries, const std::string& folder) {
        SeamEntries out;
        out.file_ = std::make_shared<SlabStore>(1, entries.size(), 0, folder);
        std::copy(entries.begin(), entries.end(), out.file_->slab(0).begin());
        return out;
    }

    bool on_disk() const { return file_ != nullptr; }
    std::span<const std::uint16_t> all() const { return file_ ? std::as_const(*file_).slab(0) : std::span<const std::uint16_t>(held_); }
    std::span<std::uint16_t> all() { return file_ ? file_->slab(0) : std::span<std::uint16_t>(held_); }
    operator std::span<const std::uint16_t>() const { return all(); }

    std::size_t size() const { return all().size(); }
    auto begin() const { return all().begin(); }
    auto end() const { return all().end(); }
    std::uint16_t operator[](std::size_t column) const { return all()[column]; }
    bool operator==(const SeamEntries& other) const { return std::ranges::equal(all(), other.all()); }

private:
    std::vector<std::uint16_t> held_;
    std::shared_ptr<SlabStore> file_;
};

}  // namespace fluidcarve
