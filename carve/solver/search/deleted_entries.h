#pragma once

#include "carve/base/frame_store.h"
#include "carve/base/limits.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace fluidcarve {

/// The entries of each column that seams have deleted: a bit for each original entry.
class DeletedEntries {
public:
    /// @param width  original entries per column
    DeletedEntries(std::size_t columns, int width, const Limits& limits)
        : words_((static_cast<std::size_t>(width) + 15) / 16),
          store_(1, columns * words_, limits) {}

    /// Deletes a seam.
    /// @param at  its entries in the space that earlier seams left; become original entries
    void to_original(std::span<std::uint16_t> at);
    /// The same in the other direction: takes original entries, which become entries in that space.
    void from_original(std::span<std::uint16_t> at);

private:
    template <class Visit>
    void each(std::span<std::uint16_t> at, const Visit& visit);

    std::size_t words_;  ///< per column
    FrameStore store_;
};

}  // namespace fluidcarve
