#include "carve/solver/search/strip_messages.h"

#include "carve/solver/search/protection.h"
#include "carve/solver/search/wavefront.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace fluidcarve {

namespace {

/// Cost of a hole where a seam has no other way: less than that of an impossible step.
constexpr float hole = 1e20f;
/// Share by which another entry must be cheaper than the seam's own: above the rounding errors of
/// sums.
constexpr float least_gain = 1e-5f;

/// Columns along each dimension that a thread visits one after the other. Long rows are read
/// faster; a few frames leave too little to share.
std::array<std::size_t, 3> box_of_messages(const std::array<std::size_t, 3>& size) {
    if (size[0] * size[1] * size[2] < least_shared_columns) return size;
    if (size[2] < 8) return {16, 8, 4};
    return {128, 8, 2};
}

/// The values at other places, each 0 to 7.
FLUIDCARVE_INLINE Eight picked(Eight values, EightPlaces from) {
#if defined(__clang__)
    return __builtin_shufflevector(values, from);
#else
    return __builtin_shuffle(values, from);
#endif
}
/// Costs of a column's entries, moved back by `by` entries, -2 to 2. The last given cost is
/// infinite; it fills the places that become free.
FLUIDCARVE_INLINE Eight moved(Eight costs, int by) {
    alignas(64) static constexpr std::array<std::int32_t, 12> from{7, 7, 0, 1, 2, 3,
                                                                   4, 5, 6, 7, 7, 7};
    EightPlaces entries;
    std::memcpy(&entries, from.data() + 2 - by, sizeof entries);
    return picked(costs, entries);
}

/// Data of a pass.
struct Pass {
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

/// Cost of the cheapest way from a neighbour to each entry of a column, including the step
/// (StepCosts).
/// @param costs  of the neighbour's entries
template <bool edges>
FLUIDCARVE_INLINE Eight sent(const Pass& pass, const Eight& costs, std::size_t from, std::size_t to,
                             std::size_t along) {
    const int off = static_cast<int>(pass.band[from].first) - static_cast<int>(pass.band[to].first);
    // Intervals of neighbours differ by at most 1 (Band).
    const auto stay = moved(costs, off);
    auto rise = moved(costs, off + 1), fall = moved(costs, off - 1);
    const auto& price = pass.prices[along];
    if constexpr (!edges) return least(stay, least(rise, fall) + eight_of(price.rigidity));
    const auto* const there = pass.fields + to * (pass.width + 2);
    const auto here = eight_at(pass.fields + from * (pass.width + 2) + 1 - off),
               above = eight_at(there), below = eight_at(there + 2),
               weight = eight_of(price.weight);
    rise += price.rigid(here, above) + weight * absolute(here - above);
    fall += price.rigid(here, below) + weight * absolute(here - below);
    return least(stay, least(rise, fall));
}

/// Costs that are 0 at one entry of a column, and infinite elsewhere.
FLUIDCARVE_INLINE Eight only_at(const Pass& pass, std::size_t column, std::uint16_t entry) {
    return eight_places == entry - pass.band[column].first ? Eight{} : eight_of(endless_cost);
}

/// The neighbours of a column along a dimension, in the order of columns. In a ring they go round.
struct Neighbours {
    std::size_t previous, next;
};

FLUIDCARVE_INLINE Neighbours neighbours_of(const Pass& pass, std::size_t column, std::size_t place,
                                           std::size_t d) {
    const auto step = pass.step[d], around = step * (pass.size[d] - 1);
    return {place == 0 ? column + around : column - step,
            place + 1 == pass.size[d] ? column - around : column + step};
}

/// A column and the one that closes a ring with it: the ring's first and last columns are
/// neighbours, too.
struct Closing {
    bool is = false;
    bool ahead = false;  ///< whether the pass visits the other one later
    std::size_t other = 0;
    /// The column that the message between both belongs to: the ring's last.
    std::size_t owner = 0;
};

/// @param at  the column's place in the ring, from its first on
FLUIDCARVE_INLINE Closing closing_of(const Pass& pass, std::size_t column, const Neighbours& beside,
                                     std::size_t at, std::size_t d) {
    const bool first = at == 0, last = at + 1 == pass.size[d];
    if (!pass.columns.ring(d) || !(first || last)) return {};
    return {true, first == pass.forward, first ? beside.previous : beside.next,
            first ? beside.previous : column};
}

/// Where a seam may be in a column so that the ring still closes: within a cone around its entry in
/// the ring's first column.
/// @param at     the column's place in the ring, from its first on
/// @param first  the ring's first column
FLUIDCARVE_INLINE Eight cone(const Pass& pass, std::size_t column, std::size_t at,
                             std::size_t first, std::size_t d) {
    const int off = pass.band[column].first - pass.taken[first],
              left = static_cast<int>(pass.size[d] - at);
    return ((eight_places + off > left) | (eight_places + off < -left)) ? eight_of(endless_cost)
                                                                        : Eight{};
}

/// Passes messages through the columns of a row.
/// @param begin, end  along the lateral dimension, in the order of the pass
/// @param k, t        of the row, likewise
/// @tparam plain      without rings and holes, and no seam is wanted
template <bool edges, bool forward, bool plain>
FLUIDCARVE_INLINE void pass_row(const Pass& pass, std::size_t begin, std::size_t end, std::size_t k,
                                std::size_t t) {
    const bool rings = !plain && pass.rings, holes = !plain && pass.holes;
    const EightPlaces outside = eight_places >= static_cast<std::int32_t>(pass.width);
    // Places from a ring's first column on, and from column 0 on.
    const auto in_order = [&](std::size_t d, std::size_t at)
                              FLUIDCARVE_INLINED { return forward ? at : pass.size[d] - 1 - at; };
    const auto turned = [&](std::size_t d, std::size_t at) FLUIDCARVE_INLINED {
        const auto place = at + pass.origin[d];
        return place < pass.size[d] ? place : place - pass.size[d];
    };
    std::array<std::size_t, 3> at{0, in_order(1, k), in_order(2, t)},
        place{0, turned(1, at[1]), at[2]};
    const auto row = pass.columns.at(0, place[1], place[2]);
    // Whether there are neighbours that the pass has visited before and that it visits later.
    std::array<bool, 3> before{false, k > 0, t > 0},
        ahead{false, k + 1 < pass.size[1], t + 1 < pass.size[2]};
    Eight sent_along{};  // the message from the column before in the row: added last, since it
                         // comes last
    for (auto lateral = begin; lateral < end; ++lateral) {
        at[0] = in_order(0, lateral);
        place[0] = turned(0, at[0]);
        before[0] = lateral > 0;
        ahead[0] = lateral + 1 < pass.size[0];
        const auto column = row + place[0];
        const std::array neighbours{neighbours_of(pass, column, place[0], 0),
                                    neighbours_of(pass, column, place[1], 1),
                                    neighbours_of(pass, column, place[2], 2)};
        const auto beside = [&](std::size_t d, bool later) FLUIDCARVE_INLINED {
            return later == forward ? neighbours[d].next : neighbours[d].previous;
        };
        // A message belongs to the earlier of two columns, in the order of columns.
        const auto message = [&](std::size_t d, bool later) FLUIDCARVE_INLINED -> Eight& {
            return pass.messages[later == forward ? column : neighbours[d].previous].along[d];
        };
        std::array<Closing, 2> closings;
        float lines = pass.lines;
        if (rings)
            for (std::size_t d = 0; d < 2; ++d) {
                closings[d] = closing_of(pass, column, neighbours[d], at[d], d);
                lines += closings[d].is ? 1 : 0;
            }
        auto sum = least(eight_at(pass.energies + column * pass.width), eight_of(endless_cost)),
             choice = sum;
#pragma GCC unroll 3
        for (std::size_t d = 0; d < 3; ++d) {
            if (d > 0 && before[d]) sum += message(d, false);
            if (!ahead[d]) continue;
            const auto from_ahead = message(d, true);
            sum += from_ahead;
            choice += from_ahead;
        }
        if (before[0]) sum += lateral > begin ? sent_along : message(0, false);
        if (rings)
            for (std::size_t d = 0; d < 2; ++d) {
                if (!closings[d].is) continue;
                const auto& closing = pass.messages[closings[d].owner].along[d];
                sum += closing;
                if (closings[d].ahead) choice += closing;
            }
        const int first = pass.band[column].first, own = pass.seam[column] - first;
        if (!plain && pass.taken != nullptr) {
            // Holes may block all ways. Then the seam passes some holes, and is moved aside later.
            if (holes) choice = least(choice, eight_of(hole));
            const auto add_step = [&](std::size_t other, std::size_t d) FLUIDCARVE_INLINED {
                choice +=
                    sent<edges>(pass, only_at(pass, other, pass.taken[other]), other, column, d);
            };
            for (std::size_t d = 0; d < 3; ++d)
                if (before[d]) add_step(beside(d, false), d);
            if (rings)
                for (std::size_t d = 0; d < 2; ++d) {
                    const auto first_of_ring =
                        column + pass.origin[d] * pass.step[d] - place[d] * pass.step[d];
                    if (pass.columns.ring(d) && at[d] > 0)
                        choice += cone(pass, column, at[d], first_of_ring, d);
                    if (closings[d].is && !closings[d].ahead) add_step(closings[d].other, d);
                }
            int best = own;
            float cheapest = choice[own] - least_gain * std::abs(choice[own]);
            for (int n = 0; n < static_cast<int>(pass.width); ++n)
                if (choice[n] < cheapest) {
                    best = n;
                    cheapest = choice[n];
                }
            pass.taken[column] = static_cast<std::uint16_t>(first + best);
        }
        const EightPlaces closed = holes ? outside | (sum > 0.5f * endless_cost) : outside;
        const auto shared = sum * (1 / lines);
        const auto send = [&](Eight& to, std::size_t other, std::size_t d) FLUIDCARVE_INLINED {
            auto part = shared - to;
            // Any free entry may be the one that counts as 0.
            int zero = own;
            if (holes) {
                part = closed ? eight_of(endless_cost) : part;
                for (int n = 0; n < 8; ++n)
                    if (part[n] < part[zero]) zero = n;
            }
            part = closed ? eight_of(endless_cost) : part - picked(part, EightPlaces{} + zero);
            to = sent<edges>(pass, part, column, other, d);
            if (holes) to = least(to, eight_of(endless_cost));
            return to;
        };
#pragma GCC unroll 3
        for (std::size_t d = 0; d < 3; ++d)
            if (ahead[d]) {
                const auto to_next = send(message(d, true), beside(d, true), d);
                if (d == 0) sent_along = to_next;
            }
        if (rings)
            for (std::size_t d = 0; d < 2; ++d)
                if (closings[d].is && closings[d].ahead)
                    send(pass.messages[closings[d].owner].along[d], closings[d].other, d);
    }
}

template <bool edges>
FLUIDCARVE_INLINE void pass_any_row(const Pass& pass, std::size_t begin, std::size_t end,
                                    std::size_t k, std::size_t t) {
    const bool plain = !pass.rings && !pass.holes && pass.taken == nullptr;
    if (pass.forward)
        plain ? pass_row<edges, true, true>(pass, begin, end, k, t)
              : pass_row<edges, true, false>(pass, begin, end, k, t);
    else
        plain ? pass_row<edges, false, true>(pass, begin, end, k, t)
              : pass_row<edges, false, false>(pass, begin, end, k, t);
}

FLUIDCARVE_WIDE void pass_free(const Pass& pass, std::size_t begin, std::size_t end, std::size_t k,
                               std::size_t t) {
    pass_any_row<false>(pass, begin, end, k, t);
}
FLUIDCARVE_WIDE void pass_edges(const Pass& pass, std::size_t begin, std::size_t end, std::size_t k,
                                std::size_t t) {
    pass_any_row<true>(pass, begin, end, k, t);
}

/// A message at half the resolution, interpolated along the axis to the entries of a finer column.
class Finer {
public:
    /// @param width  of the coarse strip
    /// @param first  its first entry
    FLUIDCARVE_INLINE Finer(Eight coarse, std::size_t width, int first) : first_(first) {
        for (auto n = static_cast<int>(width); n < 8; ++n) coarse[n] = coarse[n - 1];
        const auto before = __builtin_shufflevector(coarse, coarse, 0, 0, 1, 2, 3, 4, 5, 6),
                   behind = __builtin_shufflevector(coarse, coarse, 1, 2, 3, 4, 5, 6, 7, 7);
        // Every second entry is nearer to the coarse entry before.
        const Eight even = 0.75f * coarse + 0.25f * before, odd = 0.75f * coarse + 0.25f * behind;
        set(0, eight_of(coarse[0]));
        set(8, __builtin_shufflevector(even, odd, 0, 8, 1, 9, 2, 10, 3, 11));
        set(16, __builtin_shufflevector(even, odd, 4, 12, 5, 13, 6, 14, 7, 15));
        set(24, eight_of(coarse[7]));
    }
    /// Eight entries of the finer column, from one on that is counted from the window's first.
    FLUIDCARVE_INLINE Eight from(int entry) const {
        return eight_at(values_.data() + std::clamp(entry - 2 * first_ + 8, 0, 24));
    }

private:
    FLUIDCARVE_INLINE void set(std::size_t at, Eight values) {
        std::memcpy(values_.data() + at, &values, sizeof values);
    }

    int first_;
    std::array<float, 32> values_;  ///< from eight entries before the strip's first on
};

/// Interpolates the messages to the finer columns that a coarse one stands for. Finer lines have
/// twice as many columns and cost twice as much.
FLUIDCARVE_WIDE void interpolate(const Strip& coarse, const ColumnMessages* coarse_messages,
                                 const Columns::Place& at, const Strip& fine, int window_first,
                                 ColumnMessages* out) {
    const auto &few = coarse.columns(), &many = fine.columns();
    const auto column = few.at(at.lateral, at.k, at.t);
    const std::array<std::size_t, 3> place{at.lateral, at.k, at.t},
        step{1, few.laterals(), few.per_frame()},
        size{many.laterals(), many.slices(), many.frames()};
    for (std::size_t d = 0; d < 3; ++d) {
        const auto of = [&](std::size_t c) FLUIDCARVE_INLINED {
            return Finer(coarse_messages[c].along[d], coarse.width(), coarse[c].first);
        };
        // The first column of two lies between this message and the one before.
        const auto here = of(column), before = of(place[d] > 0 ? column - step[d] : column);
        for (unsigned corner = 0; corner < 8; ++corner) {
            std::array<std::size_t, 3> to;
            bool inside = true;
            for (std::size_t n = 0; n < 3; ++n) {
                to[n] = 2 * place[n] + (corner >> n & 1);
                inside = inside && to[n] < size[n];
            }
            if (!inside) continue;
            const auto c = many.at(to[0], to[1], to[2]);
            const int first = fine[c].first - window_first;
            // The message that closes a ring does not lie between two coarse ones: it begins with
            // 0.
            const bool closes = many.ring(d) && to[d] + 1 == size[d];
            out[c].along[d] =
                closes ? Eight{} : here.from(first) + (corner >> d & 1 ? here : before).from(first);
        }
    }
}

}  // namespace

StripMessages::StripMessages(Strip strip, const KeptMemory& memory)
    : strip_(std::move(strip)), messages_(memory.array<ColumnMessages>(strip_.columns().count())) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, messages_.size(), 4096),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          std::fill_n(messages_.data() + range.begin(), range.size(),
                                      ColumnMessages{});
                      });
}

StripMessages::StripMessages(Strip strip, Window window, const StripMessages& coarse,
                             const KeptMemory& memory)
    : strip_(std::move(strip)), messages_(memory.array<ColumnMessages>(strip_.columns().count())) {
    const auto& few = coarse.strip_.columns();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, few.count(), 256),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (auto c = range.begin(); c < range.end(); ++c)
                              interpolate(coarse.strip_, coarse.messages_.data(), few.place(c),
                                          strip_, window.first, messages_.data());
                      });
}

void StripMessages::pass(bool forward, const Origin& origin, const std::vector<std::uint16_t>& seam,
                         std::vector<std::uint16_t>* taken, const std::function<void()>& tick) {
    const auto& columns = strip_.columns();
    const auto& steps = strip_.steps();
    const std::array size{columns.laterals(), columns.slices(), columns.frames()};
    const Pass work{columns,
                    strip_.band().columns.data(),
                    strip_.energies(0),
                    steps.has_field() ? strip_.fields(0) : nullptr,
                    strip_.width(),
                    {steps.price(false), steps.price(false), steps.price(true)},
                    size,
                    {1, columns.laterals(), columns.per_frame()},
                    {origin[0], origin[1], 0},
                    static_cast<float>(std::max<std::ptrdiff_t>(
                        std::ranges::count_if(size, [](std::size_t n) { return n > 1; }), 1)),
                    columns.ring(0) || columns.ring(1),
                    strip_.protects(),
                    forward,
                    seam.data(),
                    taken != nullptr ? taken->data() : nullptr,
                    messages_.data()};
    in_wavefront(
        size, box_of_messages(size), [] { return 0; },
        [&](const Box& box, int) {
            for (auto t = box.begin[2]; t < box.end[2]; ++t)
                for (auto k = box.begin[1]; k < box.end[1]; ++k) {
                    if (work.fields != nullptr) pass_edges(work, box.begin[0], box.end[0], k, t);
                    else pass_free(work, box.begin[0], box.end[0], k, t);
                }
        },
        [&](double) { tick(); });
}

void StripMessages::forget(const Origin& origin) {
    const auto& columns = strip_.columns();
    const std::array size{columns.laterals(), columns.slices()};
    for (std::size_t d = 0; d < 2; ++d) {
        if (!columns.ring(d)) continue;
        const auto last = (origin[d] + size[d] - 1) % size[d];
        for (std::size_t c = 0; c < messages_.size(); ++c)
            if (const auto at = columns.place(c); (d == 0 ? at.lateral : at.k) == last)
                messages_[c].along[d] = Eight{};
    }
}

void StripMessages::improve(std::vector<std::uint16_t>& seam, int passes, bool goes_on,
                            const std::function<void()>& tick) {
    const auto& columns = strip_.columns();
    if (!columns.ring(0) && !columns.ring(1)) return improve(seam, passes, {0, 0}, goes_on, tick);
    // Seams around a ring cost most beside the column at which messages begin. So they begin at the
    // middle, then at column 0.
    const Origin middle{columns.ring(0) ? columns.laterals() / 2 : 0,
                        columns.ring(1) ? columns.slices() / 2 : 0};
    improve(seam, passes, middle, true, tick);
    forget(middle);
    forget({0, 0});
    improve(seam, passes, {0, 0}, goes_on, tick);
}

void StripMessages::improve(std::vector<std::uint16_t>& seam, int passes, const Origin& origin,
                            bool goes_on, const std::function<void()>& tick) {
    auto found = seam;
    for (int n = 0; n < passes; ++n) {
        const bool last = n + 1 == passes;
        pass(true, origin, seam, last ? &found : nullptr, tick);
        if (!last || goes_on) pass(false, origin, seam, nullptr, tick);
    }
    if (strip_.protects())
        found = moved_aside(
            strip_.columns(), found, strip_.band(),
            [&](std::size_t c, int entry) { return strip_.energy(c, entry); }, strip_.steps());
    if (strip_.energy(found) < strip_.energy(seam)) seam = std::move(found);
}

}  // namespace fluidcarve
