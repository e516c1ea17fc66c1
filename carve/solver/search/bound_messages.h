#pragma once

#include "carve/base/frame_store.h"
#include "carve/base/limits.h"
#include "carve/simd/wide.h"
#include "carve/solver/search/bound_column.h"
#include "carve/solver/search/columns.h"
#include "carve/solver/search/wavefront.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace fluidcarve {

using Sizes = std::array<std::size_t, 3>;

/// Interpolates along the axis to twice the resolution.
/// @param coarse  with the first value also before it, and the last also behind it
void interpolate(const float* __restrict coarse, std::span<float> out);

/// Replaces infinite values by the nearest finite ones, of two by the lower, so that interpolation
/// does not spread them.
void fill_infinite(std::span<float> values);

/// Messages to columns, `[dimension][column][entry]`. For each entry of a column, a message holds
/// the least cost, on one side of the column's line, of a seam through the entry, minus the
/// smallest of these costs. The upper half of each float's bits is kept: any message is valid.
class Messages {
public:
    Messages(std::span<const std::size_t> dimensions, std::size_t columns, std::size_t width,
             const Limits& limits)
        : columns_(columns), width_(whole_eights(width)) {
        const Limits of_each{limits.memory / dimensions.size(), limits.folder};
        for (const auto d : dimensions) stores_[d].emplace(1, columns * width_, of_each);
    }
    /// The upper halves of a message's entries; whole_eights() of them.
    std::uint16_t* message(std::size_t dimension, std::size_t column) {
        return stores_[dimension]->entries(0).data() + column * width_;
    }
    void get(std::size_t dimension, std::size_t column, std::span<float> message) const {
        const auto* const bits = stores_[dimension]->entries(0).data() + column * width_;
        for (std::size_t i = 0; i < message.size(); ++i) message[i] = from_upper(bits[i]);
    }
    /// One entry of a message.
    float entry(std::size_t dimension, std::size_t column, std::size_t at) const {
        return from_upper(stores_[dimension]->entries(0)[column * width_ + at]);
    }
    /// Whether there are messages along a dimension.
    bool has(std::size_t dimension) const { return stores_[dimension].has_value(); }
    /// Deletes an entry of each message to a column; the entries behind it move down.
    /// @param first  is subtracted from each of the entries
    void remove(std::span<const std::uint16_t> entries, std::size_t first) {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, columns_, 1024),
                          [&](const tbb::blocked_range<std::size_t>& range) {
                              for (std::size_t d = 0; d < stores_.size(); ++d)
                                  for (auto c = range.begin(); has(d) && c < range.end(); ++c) {
                                      auto* const halves = message(d, c);
                                      std::copy(halves + (entries[c] - first) + 1, halves + width_,
                                                halves + (entries[c] - first));
                                  }
                          });
    }

private:
    std::size_t columns_, width_;
    std::array<std::optional<FrameStore>, 3> stores_;
};

/// Messages at half the resolution (restrict_energy()), from the columns behind each column. Those
/// of the full resolution start from them.
class CoarseMessages {
public:
    /// @param infinite  whether some messages are infinite: where vertices are protected
    CoarseMessages(const Columns& columns, std::size_t width, bool infinite, Messages messages)
        : columns_(columns), width_(width), infinite_(infinite), messages_(std::move(messages)) {}

    bool has(std::size_t dimension) const { return messages_.has(dimension); }
    /// Interpolates the message to a column of the full resolution. Lines of full resolution have
    /// twice as many columns and cost twice as much.
    /// @param at      lateral, slice and frame at the full resolution
    /// @param buffer  for two messages
    void get(std::size_t dimension, const Sizes& at, std::span<float> message,
             std::vector<float>& buffer) const {
        buffer.resize(2 * (width_ + 2));
        const std::span sum(buffer.data() + 1, width_), other(sum.data() + width_ + 2, width_);
        Sizes coarse{at[0] / 2, at[1] / 2, at[2] / 2};
        messages_.get(dimension, columns_.at(coarse[0], coarse[1], coarse[2]), sum);
        // The first column of two lies between this message and the one before.
        if (at[dimension] % 2 == 0 && coarse[dimension] > 0) {
            --coarse[dimension];
            messages_.get(dimension, columns_.at(coarse[0], coarse[1], coarse[2]), other);
            for (std::size_t i = 0; i < width_; ++i) sum[i] += other[i];
        } else {
            for (auto& value : sum) value *= 2;
        }
        if (infinite_) fill_infinite(sum);
        buffer[0] = sum.front();
        buffer[width_ + 1] = sum.back();
        interpolate(sum.data(), message);
    }

private:
    Columns columns_;
    std::size_t width_;
    bool infinite_;
    Messages messages_;
};

}  // namespace fluidcarve
