#pragma once

#include "nodes/seam/search/strip.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace fluidcarve {

/// Improves a seam within a strip, by messages along all lines of columns at once (METHOD 8 "Messages"; sequential tree-reweighted message
/// passing, Kolmogorov 2006). A message tells each entry of a column what the rest of a line asks for a seam through it.
class StripMessages {
public:
    /// The widest strip, entries.
    static constexpr int most_entries = 7;

    /// Eight values, one for each entry of a column in a strip, and at least one that says nothing.
    using Eight = float __attribute__((vector_size(32)));
    /// Messages between a column and the next one along each dimension. After a pass forward they are from the column, after a pass back to it.
    struct alignas(32) Messages {
        Eight along[3];
    };

    /// Messages that say nothing yet.
    /// @param strip   of at most most_entries in a column
    /// @param memory  of the messages
    explicit StripMessages(Strip strip, const KeptMemory& memory = {});
    /// Messages that begin with those at half the resolution, interpolated.
    /// @param window  as for restrict_energy()
    StripMessages(Strip strip, Window window, const StripMessages& coarse, const KeptMemory& memory = {});

    const Strip& strip() const { return strip_; }

    /// Passes messages to and fro, and takes the seam that they lead to if it is cheaper. Ties go to the given seam.
    /// @param seam     feasible, in the strip, of finite cost; stays so
    /// @param passes   to and fro
    /// @param goes_on  whether finer messages will begin with these; else the last pass back is left out
    /// @param tick     called often; may throw to stop
    void improve(std::vector<std::uint16_t>& seam, int passes, bool goes_on, const std::function<void()>& tick);

private:
    /// Where rings begin, along lateral and k.
    using Origin = std::array<std::size_t, 2>;

    void improve(std::vector<std::uint16_t>& seam, int passes, const Origin& origin, bool goes_on, const std::function<void()>& tick);
    /// Clears the messages that close rings: if rings begin elsewhere, these go the other way.
    void forget(const Origin& origin);
    /// Passes messages through all columns.
    /// @param forward  in the order of columns; else against it
    /// @param seam     as for improve()
    /// @param taken    becomes the seam that the messages lead to, which may pass protected vertices; null: none is wanted
    void pass(bool forward, const Origin& origin, const std::vector<std::uint16_t>& seam, std::vector<std::uint16_t>* taken, const std::function<void()>& tick);

    Strip strip_;
    KeptMemory::Array<Messages> messages_;  ///< `[column]`
};

}  // namespace fluidcarve
