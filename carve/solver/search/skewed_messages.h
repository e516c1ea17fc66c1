#pragma once

#include "carve/solver/search/column_messages.h"
#include "carve/solver/search/kept_memory.h"
#include "carve/solver/search/strip.h"
#include "carve/solver/search/wavefront.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace fluidcarve {

/// Messages of a strip in an order that passes eight columns at once: those of eight slices, each
/// one lateral place behind the slice before. None of them waits for another, so columns are still
/// visited in their order (loop skewing, Wolfe 1986). A vector holds one entry of the eight
/// columns. Without rings and protected vertices.
class SkewedMessages {
public:
    /// Whether messages of a strip can be passed this way, and fast: it has as many slices as a
    /// vector has lanes, and is as wide as strips get.
    static bool fits(const Strip& strip);

    /// @param strip     it fits; must outlive this
    /// @param messages  `[column]`
    SkewedMessages(const Strip& strip, const ColumnMessages* messages, const KeptMemory& memory);

    /// Passes messages through all columns, in their order and against it.
    /// @param turns  odd. Columns are visited in tiles. If it is more than 1, messages are passed
    ///   so often in each tile before the next one: to,
    ///               fro, ..., to. So each is read from memory less often, and the pass does about
    ///               as much as `turns` of them.
    /// @param tick   called often; may throw to stop
    void to_and_fro(int turns, const std::function<void()>& tick);
    /// Writes the messages `[column]`.
    void write(ColumnMessages* messages) const;

    static constexpr std::size_t lanes = 8, entries = ColumnMessages::most_entries;
    /// A value of each entry of eight columns.
    using Costs = std::array<Eight, entries>;
    /// The fields of eight columns, from one entry before their intervals to one behind them.
    using Fields = std::array<Eight, entries + 2>;
    /// The messages between eight columns and the next ones along each dimension.
    struct Messages {
        Costs along[3];
    };
    /// How the intervals of eight columns lie to those of their neighbours: for each lane, two bits
    /// for each of six neighbours.
    struct Offsets {
        std::uint16_t lanes[SkewedMessages::lanes];
    };

private:
    void pass(bool forward, int turns, const std::function<void()>& tick);
    void pass_tile(const Box& tile, bool forward, int turns);
    /// Blocks and frames of a tile, in the last two dimensions.
    std::array<std::size_t, 3> tile(int turns) const;
    /// Calls `call(t * blocks + block)`.
    template <class Call>
    void for_rows(const Call& call) const;

    const Strip& strip_;
    std::array<std::size_t, 3> size_;       ///< columns along each dimension
    std::size_t blocks_, steps_;            ///< groups of eight slices; steps through one of them
    KeptMemory::Array<Messages> messages_;  ///< `[t][block][step]`, as are all of these
    KeptMemory::Array<Costs> energies_;
    KeptMemory::Array<Fields> fields_;  ///< empty: the strip has none
    KeptMemory::Array<Offsets> offsets_;
};

}  // namespace fluidcarve
