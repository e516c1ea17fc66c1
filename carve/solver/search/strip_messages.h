#pragma once

#include "carve/solver/search/column_messages.h"
#include "carve/solver/search/strip.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace fluidcarve {

/// Improves a seam within a strip, by messages along all lines of columns at once (METHOD 8
/// "Messages"; sequential tree-reweighted message passing, Kolmogorov 2006). For each entry of a
/// column, a message holds what the rest of a line costs a seam through that entry.
class StripMessages {
public:
    /// Starts with messages of 0.
    /// @param strip   of at most ColumnMessages::most_entries in a column
    /// @param memory  of the messages
    explicit StripMessages(Strip strip, const KeptMemory& memory = {});
    /// Starts with the messages at half the resolution, interpolated.
    /// @param window  as for restrict_energy()
    StripMessages(Strip strip, Window window, const StripMessages& coarse,
                  const KeptMemory& memory = {});

    const Strip& strip() const { return strip_; }

    /// Passes messages to and fro, and takes the resulting seam if it is cheaper. Ties go to the
    /// given seam.
    /// @param seam     feasible, in the strip, of finite cost; stays so
    /// @param passes   to and fro
    /// @param goes_on  whether finer messages will begin with these; else the last pass back is
    ///   left out
    /// @param check    called often; may throw to stop
    void improve(std::vector<std::uint16_t>& seam, int passes, bool goes_on,
                 const std::function<void()>& check);

private:
    /// Where rings begin, along lateral and slice.
    using Origin = std::array<std::size_t, 2>;

    void improve(std::vector<std::uint16_t>& seam, int passes, const Origin& origin, bool goes_on,
                 const std::function<void()>& check);
    /// Clears the messages that close rings: if rings begin elsewhere, these messages run the
    /// other way.
    void forget(const Origin& origin);
    /// Passes messages through all columns.
    /// @param forward  in the order of columns; else against it
    /// @param seam     as for improve()
    /// @param taken    becomes the seam that the messages lead to, which may pass protected
    ///   vertices; null: none is wanted
    void pass(bool forward, const Origin& origin, const std::vector<std::uint16_t>& seam,
              std::vector<std::uint16_t>* taken, const std::function<void()>& check);

    Strip strip_;
    KeptMemory::Array<ColumnMessages> messages_;  ///< `[column]`
};

}  // namespace fluidcarve
