#pragma once

#include "carve/simd/eight.h"
#include "carve/simd/wide.h"
#include "carve/solver/costs/step_costs.h"
#include "carve/solver/search/band.h"
#include "carve/solver/search/column_messages.h"
#include "carve/solver/search/columns.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace fluidcarve {

/// Data of a pass.
struct MessagePass {
    const Columns& columns;
    const Band::Column* band;  ///< `[column]`
    const float* energies;     ///< `[column][entry]`, `width` entries in a column
    /// `[column][entry]`, with one entry more before and behind those of the strip.
    const float* fields;
    std::size_t width;
    std::array<StepPrice, 3> prices;  ///< of a step along each dimension
    std::array<std::size_t, 3> size,
        step;                           ///< columns along each dimension, and from one to the next
    std::array<std::size_t, 3> origin;  ///< the first column of each ring; 0 of other lines
    float lines;  ///< dimensions of more than one column: so many lines go through a column
    bool rings;   ///< whether some of them close
    bool holes;   ///< whether some entries can't be taken
    bool forward;
    const std::uint16_t* seam;  ///< `[column]`
    std::uint16_t* taken;       ///< likewise; null: no seam is wanted
    ColumnMessages* messages;   ///< `[column]`
};

/// Passes messages through the columns of a row.
/// @tparam plain  without rings and holes, and no seam is wanted
template <bool edges, bool forward, bool plain>
class RowPass {
public:
    /// @param k, t  of the row, in the order of the pass
    FLUIDCARVE_INLINE RowPass(const MessagePass& pass, std::size_t k, std::size_t t)
        : pass_(pass),
          outside_(eight_places >= static_cast<std::int32_t>(pass.width)),
          at_{0, in_order(1, k), in_order(2, t)},
          place_{0, turned(1, at_[1]), at_[2]},
          row_(pass.columns.at(0, place_[1], place_[2])),
          before_{false, k > 0, t > 0},
          ahead_{false, k + 1 < pass.size[1], t + 1 < pass.size[2]} {}

    /// @param begin, end  along the lateral dimension, in the order of the pass
    FLUIDCARVE_INLINE void run(std::size_t begin, std::size_t end) {
        for (auto lateral = begin; lateral < end; ++lateral) {
            go_to(lateral);
            sum_up(lateral > begin);
            if (!plain && pass_.taken != nullptr) take();
            send_on();
        }
    }

private:
    /// Cost of a hole where a seam has no other way: less than that of an impossible step.
    static constexpr float hole_cost = 1e20f;
    /// Share by which another entry must be cheaper than the seam's own: above the rounding errors
    /// of sums.
    static constexpr float least_gain = 1e-5f;

    /// The neighbours of a column along a dimension, in the order of columns. In a ring they go
    /// round.
    struct Neighbours {
        std::size_t previous, next;
    };

    /// A column and the one that closes a ring with it: the ring's first and last columns are
    /// neighbours, too.
    struct Closing {
        bool is = false;
        bool ahead = false;  ///< whether the pass visits the other one later
        std::size_t other = 0;
        /// The column that the message between both belongs to: the ring's last.
        std::size_t owner = 0;
    };

    /// The place from a ring's first column on.
    FLUIDCARVE_INLINE std::size_t in_order(std::size_t d, std::size_t at) const {
        return forward ? at : pass_.size[d] - 1 - at;
    }
    /// The place from column 0 on.
    FLUIDCARVE_INLINE std::size_t turned(std::size_t d, std::size_t at) const {
        const auto place = at + pass_.origin[d];
        return place < pass_.size[d] ? place : place - pass_.size[d];
    }
    FLUIDCARVE_INLINE bool rings() const { return !plain && pass_.rings; }
    FLUIDCARVE_INLINE bool holes() const { return !plain && pass_.holes; }

    /// The neighbour that the pass visits later, or before.
    FLUIDCARVE_INLINE std::size_t beside(std::size_t d, bool later) const {
        return later == forward ? neighbours_[d].next : neighbours_[d].previous;
    }
    /// The message between the column and beside(). It belongs to the earlier of the two, in the
    /// order of columns.
    FLUIDCARVE_INLINE Eight& message(std::size_t d, bool later) const {
        return pass_.messages[later == forward ? column_ : neighbours_[d].previous].along[d];
    }
    FLUIDCARVE_INLINE Eight& closing_message(std::size_t d) const {
        return pass_.messages[closings_[d].owner].along[d];
    }

    /// The values at other places, each 0 to 7.
    static FLUIDCARVE_INLINE Eight picked(Eight values, EightPlaces from) {
#if defined(__clang__)
        return __builtin_shufflevector(values, from);
#else
        return __builtin_shuffle(values, from);
#endif
    }
    /// Costs of a column's entries, moved back by `by` entries, -2 to 2. The last given cost is
    /// infinite; it fills the places that become free.
    static FLUIDCARVE_INLINE Eight moved(Eight costs, int by) {
        alignas(64) static constexpr std::array<std::int32_t, 12> from{7, 7, 0, 1, 2, 3,
                                                                       4, 5, 6, 7, 7, 7};
        EightPlaces entries;
        std::memcpy(&entries, from.data() + 2 - by, sizeof entries);
        return picked(costs, entries);
    }

    FLUIDCARVE_INLINE Neighbours neighbours_of(std::size_t column, std::size_t place,
                                               std::size_t d) const {
        const auto step = pass_.step[d], around = step * (pass_.size[d] - 1);
        return {place == 0 ? column + around : column - step,
                place + 1 == pass_.size[d] ? column - around : column + step};
    }

    /// @param at  the column's place in the ring, from its first on
    FLUIDCARVE_INLINE Closing closing_of(std::size_t column, const Neighbours& beside,
                                         std::size_t at, std::size_t d) const {
        const bool first = at == 0, last = at + 1 == pass_.size[d];
        if (!pass_.columns.ring(d) || !(first || last)) return {};
        return {true, first == pass_.forward, first ? beside.previous : beside.next,
                first ? beside.previous : column};
    }

    /// Where a seam may be in a column so that the ring still closes: within a cone around its
    /// entry in the ring's first column.
    /// @param at     the column's place in the ring, from its first on
    /// @param first  the ring's first column
    FLUIDCARVE_INLINE Eight cone(std::size_t column, std::size_t at, std::size_t first,
                                 std::size_t d) const {
        const int off = pass_.band[column].first - pass_.taken[first],
                  left = static_cast<int>(pass_.size[d] - at);
        return ((eight_places + off > left) | (eight_places + off < -left)) ? eight_of(endless_cost)
                                                                            : Eight{};
    }

    /// Cost of the cheapest way from a neighbour to each entry of a column, including the step
    /// (StepCosts).
    /// @param costs  of the neighbour's entries
    FLUIDCARVE_INLINE Eight sent(const Eight& costs, std::size_t from, std::size_t to,
                                 std::size_t along) const {
        const int off =
            static_cast<int>(pass_.band[from].first) - static_cast<int>(pass_.band[to].first);
        // Intervals of neighbours differ by at most 1 (Band).
        const auto stay = moved(costs, off);
        auto rise = moved(costs, off + 1), fall = moved(costs, off - 1);
        const auto& price = pass_.prices[along];
        if constexpr (!edges) return least(stay, least(rise, fall) + eight_of(price.rigidity));
        const auto* const there = pass_.fields + to * (pass_.width + 2);
        const auto here = eight_at(pass_.fields + from * (pass_.width + 2) + 1 - off),
                   above = eight_at(there), below = eight_at(there + 2),
                   weight = eight_of(price.weight);
        rise += price.rigid(here, above) + weight * absolute(here - above);
        fall += price.rigid(here, below) + weight * absolute(here - below);
        return least(stay, least(rise, fall));
    }

    /// Costs that are 0 at one entry of a column, and infinite elsewhere.
    FLUIDCARVE_INLINE Eight only_at(std::size_t column, std::uint16_t entry) const {
        return eight_places == entry - pass_.band[column].first ? Eight{} : eight_of(endless_cost);
    }

    FLUIDCARVE_INLINE void go_to(std::size_t lateral) {
        at_[0] = in_order(0, lateral);
        place_[0] = turned(0, at_[0]);
        before_[0] = lateral > 0;
        ahead_[0] = lateral + 1 < pass_.size[0];
        column_ = row_ + place_[0];
        lines_ = pass_.lines;
        own_ = pass_.seam[column_] - pass_.band[column_].first;
        neighbours_ = {neighbours_of(column_, place_[0], 0), neighbours_of(column_, place_[1], 1),
                       neighbours_of(column_, place_[2], 2)};
        if (!rings()) return;
        for (std::size_t d = 0; d < 2; ++d) {
            closings_[d] = closing_of(column_, neighbours_[d], at_[d], d);
            lines_ += closings_[d].is ? 1 : 0;
        }
    }

    /// Adds the column's costs and messages: all of them, and for the choice of an entry those that
    /// come from columns ahead.
    /// @param follows  whether the pass visited the column before in the row just now
    FLUIDCARVE_INLINE void sum_up(bool follows) {
        sum_ = choice_ =
            least(eight_at(pass_.energies + column_ * pass_.width), eight_of(endless_cost));
#pragma GCC unroll 3
        for (std::size_t d = 0; d < 3; ++d) {
            if (d > 0 && before_[d]) sum_ += message(d, false);
            if (!ahead_[d]) continue;
            const auto from_ahead = message(d, true);
            sum_ += from_ahead;
            choice_ += from_ahead;
        }
        if (before_[0]) sum_ += follows ? sent_along_ : message(0, false);
        if (!rings()) return;
        for (std::size_t d = 0; d < 2; ++d) {
            if (!closings_[d].is) continue;
            const auto& closing = closing_message(d);
            sum_ += closing;
            if (closings_[d].ahead) choice_ += closing;
        }
    }

    /// Takes the column's entry for the seam.
    FLUIDCARVE_INLINE void take() {
        // Holes may block all ways. Then the seam passes some holes, and is moved aside later.
        if (holes()) choice_ = least(choice_, eight_of(hole_cost));
        for (std::size_t d = 0; d < 3; ++d)
            if (before_[d]) add_step(beside(d, false), d);
        if (rings())
            for (std::size_t d = 0; d < 2; ++d) {
                const auto first_of_ring =
                    column_ + pass_.origin[d] * pass_.step[d] - place_[d] * pass_.step[d];
                if (pass_.columns.ring(d) && at_[d] > 0)
                    choice_ += cone(column_, at_[d], first_of_ring, d);
                if (closings_[d].is && !closings_[d].ahead) add_step(closings_[d].other, d);
            }
        int best = own_;
        float cheapest = choice_[own_] - least_gain * std::abs(choice_[own_]);
        for (int n = 0; n < static_cast<int>(pass_.width); ++n)
            if (choice_[n] < cheapest) {
                best = n;
                cheapest = choice_[n];
            }
        pass_.taken[column_] = static_cast<std::uint16_t>(pass_.band[column_].first + best);
    }
    /// Adds the cost of the step from the entry taken in another column.
    FLUIDCARVE_INLINE void add_step(std::size_t other, std::size_t d) {
        choice_ += sent(only_at(other, pass_.taken[other]), other, column_, d);
    }

    /// Sends messages to the columns ahead.
    FLUIDCARVE_INLINE void send_on() {
        const EightPlaces closed = holes() ? outside_ | (sum_ > 0.5f * endless_cost) : outside_;
        const auto shared = sum_ * (1 / lines_);
#pragma GCC unroll 3
        for (std::size_t d = 0; d < 3; ++d)
            if (ahead_[d]) {
                const auto to_next = send(shared, closed, message(d, true), beside(d, true), d);
                if (d == 0) sent_along_ = to_next;
            }
        if (!rings()) return;
        for (std::size_t d = 0; d < 2; ++d)
            if (closings_[d].is && closings_[d].ahead)
                send(shared, closed, closing_message(d), closings_[d].other, d);
    }
    /// @param shared  the share of the sum that each line gets
    /// @param closed  entries that no seam can take
    /// @param to      the message
    FLUIDCARVE_INLINE Eight send(const Eight& shared, const EightPlaces& closed, Eight& to,
                                 std::size_t other, std::size_t d) const {
        auto part = shared - to;
        // Any free entry may be the one that counts as 0.
        int zero = own_;
        if (holes()) {
            part = closed ? eight_of(endless_cost) : part;
            for (int n = 0; n < 8; ++n)
                if (part[n] < part[zero]) zero = n;
        }
        part = closed ? eight_of(endless_cost) : part - picked(part, EightPlaces{} + zero);
        to = sent(part, column_, other, d);
        if (holes()) to = least(to, eight_of(endless_cost));
        return to;
    }

    const MessagePass& pass_;
    const EightPlaces outside_;
    // Places along lateral, slice and frame: from a ring's first column on, and from column 0 on.
    std::array<std::size_t, 3> at_, place_;
    const std::size_t row_;  ///< the row's column 0
    // Whether there are neighbours that the pass has visited before and that it visits later.
    std::array<bool, 3> before_, ahead_;
    /// The message from the column before in the row: added last, since it comes last.
    Eight sent_along_{};

    // Of the column that is visited:
    std::size_t column_ = 0;
    int own_ = 0;  ///< the seam's entry, from the band's first on
    std::array<Neighbours, 3> neighbours_{};
    std::array<Closing, 2> closings_{};
    float lines_ = 0;
    Eight sum_{}, choice_{};
};

}  // namespace fluidcarve
