#include "carve/solver/search/skewed_messages.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <span>

namespace fluidcarve {

namespace {

using Costs = SkewedMessages::Costs;
using Fields = SkewedMessages::Fields;
using Messages = SkewedMessages::Messages;
using Offsets = SkewedMessages::Offsets;
constexpr auto lanes = SkewedMessages::lanes, entries = SkewedMessages::entries;

/// Of eight columns, the values in the slices before: those of the block's other slices a step
/// before, and of the last slice of the block before.
FLUIDCARVE_INLINE Eight slices_before(Eight block_before, Eight step_before) {
    return __builtin_shufflevector(block_before, step_before, 7, 8, 9, 10, 11, 12, 13, 14);
}
/// Likewise in the slices behind.
FLUIDCARVE_INLINE Eight slices_behind(Eight step_behind, Eight block_behind) {
    return __builtin_shufflevector(step_behind, block_behind, 1, 2, 3, 4, 5, 6, 7, 8);
}

/// Rows become columns.
FLUIDCARVE_INLINE void transpose(std::array<Eight, 8>& rows) {
    std::array<Eight, 8> pairs, fours;
#pragma GCC unroll 4
    for (std::size_t n = 0; n < 8; n += 2) {
        pairs[n] = __builtin_shufflevector(rows[n], rows[n + 1], 0, 8, 1, 9, 4, 12, 5, 13);
        pairs[n + 1] = __builtin_shufflevector(rows[n], rows[n + 1], 2, 10, 3, 11, 6, 14, 7, 15);
    }
#pragma GCC unroll 2
    for (std::size_t n = 0; n < 8; n += 4)
#pragma GCC unroll 2
        for (std::size_t m = 0; m < 2; ++m) {
            fours[n + 2 * m] =
                __builtin_shufflevector(pairs[n + m], pairs[n + m + 2], 0, 1, 8, 9, 4, 5, 12, 13);
            fours[n + 2 * m + 1] =
                __builtin_shufflevector(pairs[n + m], pairs[n + m + 2], 2, 3, 10, 11, 6, 7, 14, 15);
        }
#pragma GCC unroll 4
    for (std::size_t n = 0; n < 4; ++n) {
        rows[n] = __builtin_shufflevector(fours[n], fours[n + 4], 0, 1, 2, 3, 8, 9, 10, 11);
        rows[n + 4] = __builtin_shufflevector(fours[n], fours[n + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    }
}

/// The columns of a step. Lanes before the first and behind the last lateral place, and behind the
/// last slice, have none.
struct Step {
    std::array<std::size_t, 3> size;
    std::size_t t, block, number;

    bool has(std::size_t lane) const {
        return number >= lane && number - lane < size[0] && lanes * block + lane < size[1];
    }
    std::array<std::size_t, 3> place(std::size_t lane) const {
        return {number - lane, lanes * block + lane, t};
    }
    std::size_t column(std::size_t lane) const {
        const auto at = place(lane);
        return at[0] + size[0] * (at[1] + size[1] * at[2]);
    }
};

/// Reads the values of a step's columns; 0 where it has none.
/// @param values  `[column]`, `width` of them each; up to eight are read
/// @param has     called with a lane; whether its column has values
template <std::size_t count, class Has>
FLUIDCARVE_INLINE void gather(const Step& step, const float* values, std::size_t width,
                              const Has& has, std::array<Eight, count>& out) {
    std::array<Eight, 8> rows{};
    for (std::size_t lane = 0; lane < lanes; ++lane)
        if (step.has(lane) && has(lane))
            std::memcpy(&rows[lane], values + step.column(lane) * width, sizeof rows[lane]);
    transpose(rows);
#pragma GCC unroll 8
    for (std::size_t n = 0; n < count; ++n) out[n] = rows[n];
}

constexpr auto always = [](std::size_t) { return true; };

FLUIDCARVE_WIDE void gather_messages(const Step& step, const ColumnMessages* messages,
                                     Messages& out) {
    for (std::size_t d = 0; d < 3; ++d)
        gather(
            step, reinterpret_cast<const float*>(&messages->along[d]),
            sizeof *messages / sizeof(float),
            [&](std::size_t lane)
                FLUIDCARVE_INLINED { return step.place(lane)[d] + 1 < step.size[d]; },
            out.along[d]);
}
FLUIDCARVE_WIDE void gather_energies(const Step& step, const float* energies, Costs& out) {
    gather(step, energies, entries, always, out);
    for (auto& each : out) each = least(each, eight_of(endless_cost));
}

FLUIDCARVE_WIDE void gather_fields(const Step& step, const float* fields, Fields& out) {
    std::array<Eight, entries + 1> first;
    std::array<Eight, 1> last;
    gather(step, fields, entries + 2, always, first);
    gather(step, fields + entries + 1, entries + 2, always, last);
    std::ranges::copy(first, out.begin());
    out.back() = last[0];
}

FLUIDCARVE_WIDE void scatter_messages(const Step& step, const Messages& messages,
                                      ColumnMessages* out) {
    for (std::size_t d = 0; d < 3; ++d) {
        std::array<Eight, 8> rows{};
        std::ranges::copy(messages.along[d], rows.begin());
        transpose(rows);
        for (std::size_t lane = 0; lane < lanes; ++lane)
            if (step.has(lane)) out[step.column(lane)].along[d] = rows[lane];
    }
}

/// Stand in for the messages and fields of neighbours that do not exist.
constexpr Messages no_messages{};
constexpr Fields no_fields{};

/// What a pass works on: eight slices of a frame. A pointer is to the first of their steps, unless
/// said otherwise.
struct Pass {
    std::size_t laterals;
    float lines;                    ///< so many go through a column
    std::array<float, 3> rigidity;  ///< of a step along each dimension
    float weight;                   ///< cost per unit by which the field changes across a new edge
    bool sends_to_block, sends_to_frame;  ///< whether to the slices and to the frame that come next
    std::size_t slices_behind;            ///< those of the frame behind the first of the eight
    Messages *here, *block_before, *frame_before;  ///< null: there are none
    const Costs* energies;
    const Offsets* offsets;
    const Fields *fields, *fields_of_block[2],
        *fields_of_frame[2];  ///< of the blocks and frames before and behind; null: there are none
};

/// The two bits of a neighbour in Offsets: its interval begins an entry earlier, or later.
/// @param behind  the next one along a dimension; else the one before
constexpr int bit_of(bool behind, std::size_t d, bool later) {
    return 1 << (2 * d + (behind ? 0 : 6) + (later ? 1 : 0));
}

/// Writes the offsets of eight slices of a frame, `[step]`.
void find_offsets(const Strip& strip, std::size_t t, std::size_t block, std::span<Offsets> out) {
    const auto& columns = strip.columns();
    std::ranges::fill(out, Offsets{});
    for (std::size_t lane = 0; lane < lanes && lanes * block + lane < columns.slices(); ++lane) {
        const auto k = lanes * block + lane;
        const auto* const here = strip.band().columns.data() + columns.at(0, k, t);
        // A column without a neighbour is compared with itself.
        const auto step_aside = columns.laterals(), step_frame = columns.per_frame();
        const auto *const aside = k + 1 < columns.slices() ? here + step_aside : here,
                          *const aside_before = k > 0 ? here - step_aside : here;
        const auto *const frame = t + 1 < columns.frames() ? here + step_frame : here,
                          *const frame_before = t > 0 ? here - step_frame : here;
        for (std::size_t l = 0; l < columns.laterals(); ++l) {
            const int first = here[l].first;
            const auto bits = [&](int there, bool behind, std::size_t d) {
                return (there < first ? bit_of(behind, d, false) : 0) |
                       (there > first ? bit_of(behind, d, true) : 0);
            };
            const int all = bits(here[l + 1 < columns.laterals() ? l + 1 : l].first, true, 0) |
                            bits(here[l > 0 ? l - 1 : l].first, false, 0) |
                            bits(aside[l].first, true, 1) | bits(aside_before[l].first, false, 1) |
                            bits(frame[l].first, true, 2) | bits(frame_before[l].first, false, 2);
            out[l + lane].lanes[lane] = static_cast<std::uint16_t>(all);
        }
    }
}

/// What a message pays for a step, and how the intervals of its two columns lie.
struct Way {
    EightPlaces earlier, later;  ///< where the receiving columns' intervals begin
    Eight rigidity, weight;
};

/// What each entry of a column pays for the cheapest way from a neighbour, including the step
/// (StepCosts).
/// @param costs        of the neighbour's entries
/// @param here, there  the fields of the neighbour and of the column
template <Stepping stepping>
FLUIDCARVE_INLINE void send(const Costs& costs, const Way& way, const Fields& here,
                            const Fields& there, Costs& out) {
    // By entries of the neighbour, from one before its interval to one behind it.
    std::array<Eight, entries + 2> ways;
    if constexpr (stepping == Stepping::field) {
        ways[0] = ways[entries + 1] = eight_of(endless_cost);
        std::ranges::copy(costs, ways.begin() + 1);
    } else {
        const auto rigid = [&](Eight cost) FLUIDCARVE_INLINED {
            return stepping == Stepping::free ? cost : cost + way.rigidity;
        };
        constexpr auto last = entries - 1;
        ways[0] = rigid(costs[0]);
        ways[1] = least(costs[0], rigid(costs[1]));
#pragma GCC unroll 8
        for (std::size_t n = 1; n < last; ++n)
            ways[n + 1] = least(costs[n], rigid(least(costs[n - 1], costs[n + 1])));
        ways[entries] = least(costs[last], rigid(costs[last - 1]));
        ways[entries + 1] = rigid(costs[last]);
    }
    const auto moved = [&](std::size_t n) FLUIDCARVE_INLINED {
        return way.earlier ? ways[n] : way.later ? ways[n + 2] : ways[n + 1];
    };
    if constexpr (stepping != Stepping::field) {
#pragma GCC unroll 8
        for (std::size_t n = 0; n < entries; ++n) out[n] = moved(n);
    } else {
        std::array<Eight, entries + 2> stay;
        stay[0] = way.later ? costs[0] : ways[0];
        stay[entries + 1] = way.earlier ? costs[entries - 1] : ways[0];
#pragma GCC unroll 8
        for (std::size_t n = 0; n < entries; ++n) stay[n + 1] = moved(n);
#pragma GCC unroll 8
        for (std::size_t n = 0; n < entries; ++n) {
            const auto field = way.earlier ? here[n] : way.later ? here[n + 2] : here[n + 1];
            const auto rise = stay[n] + (way.rigidity + way.weight * size_of(field - there[n])),
                       fall = stay[n + 2] +
                              (way.rigidity + way.weight * size_of(field - there[n + 2]));
            out[n] = least(stay[n + 1], least(rise, fall));
        }
    }
}

/// A pass prefetches what it reads so many steps later.
constexpr std::int32_t steps_ahead = 4;

template <class T>
FLUIDCARVE_INLINE void fetch(const T& value) {
    constexpr std::size_t line = 64;
    const auto* const bytes = reinterpret_cast<const char*>(&value);
#pragma GCC unroll 16
    for (std::size_t n = 0; n < sizeof value; n += line) __builtin_prefetch(bytes + n);
}

FLUIDCARVE_INLINE void fetch(const Pass& pass, std::int32_t step) {
    fetch(pass.here[step]);
    fetch(pass.energies[step]);
}

/// The offsets of a step's columns, in lanes.
FLUIDCARVE_INLINE EightPlaces load(const Offsets& offsets) {
    std::uint16_t __attribute__((vector_size(16))) packed;
    std::memcpy(&packed, &offsets, sizeof packed);
    return __builtin_convertvector(packed, EightPlaces);
}

/// The fields of the columns in the slices that are visited next.
template <bool forward>
FLUIDCARVE_INLINE Fields fields_aside(const Pass& pass, std::int32_t step, const Fields& of_next) {
    constexpr auto far = static_cast<std::int32_t>(lanes) - 1;
    const auto* const block = pass.fields_of_block[forward];
    const auto other = forward ? step - far : step + far;
    const bool has =
        block != nullptr && other >= 0 && other < static_cast<std::int32_t>(pass.laterals) + far;
    const auto& of_block = has ? block[other] : no_fields;
    Fields out;
    for (std::size_t n = 0; n < out.size(); ++n)
        out[n] = forward ? slices_behind(of_next[n], of_block[n])
                         : slices_before(of_block[n], of_next[n]);
    return out;
}

/// Passes messages through eight slices of a frame.
template <Stepping stepping, bool forward>
FLUIDCARVE_INLINE void pass_block(const Pass& pass) {
    constexpr bool edges = stepping == Stepping::field;
    const auto laterals = static_cast<std::int32_t>(pass.laterals),
               steps = laterals + static_cast<std::int32_t>(lanes) - 1;
    const auto share = eight_of(1 / pass.lines), weight = eight_of(pass.weight);
    Costs along{}, aside{};  // the messages sent by the last step to columns of the same slice, and
                             // of the next one
    for (std::int32_t n = 0; n < steps; ++n) {
        const auto step = forward ? n : steps - 1 - n;
        auto& here = pass.here[step];
        fetch(pass,
              forward ? std::min(step + steps_ahead, steps - 1) : std::max(step - steps_ahead, 0));
        const bool first = step == 0;
        // The last slice of the block before, where the first of this one is.
        auto* const beside = pass.block_before != nullptr && step < laterals
                                 ? pass.block_before + step + lanes - 1
                                 : nullptr;
        const auto& of_beside = beside != nullptr ? *beside : no_messages;
        const auto& of_last = first ? no_messages : pass.here[step - 1];
        auto* const of_frame = pass.frame_before != nullptr ? pass.frame_before + step : nullptr;
        const auto& of_frame_before = of_frame != nullptr ? *of_frame : no_messages;
        Costs aside_ahead;  // the message that comes from the slice that is visited next
        const auto& along_ahead = forward ? here.along[0] : of_last.along[0];
        const auto& frame_ahead = forward ? here.along[2] : of_frame_before.along[2];
        const auto& frame_back = forward ? of_frame_before.along[2] : here.along[2];
        Costs shared;
#pragma GCC unroll 8
        for (std::size_t e = 0; e < entries; ++e) {
            Eight aside_back;
            if constexpr (forward) {
                aside_back = slices_before(of_beside.along[1][e], aside[e]);
                aside_ahead[e] = here.along[1][e];
            } else {
                aside_back =
                    __builtin_shufflevector(aside[e], here.along[1][e], 1, 2, 3, 4, 5, 6, 7, 15);
                aside_ahead[e] = slices_before(of_beside.along[1][e], of_last.along[1][e]);
                here.along[1][e] = aside_back;
            }
            auto sum = pass.energies[step][e] + along_ahead[e];
            sum += aside_back;
            sum += aside_ahead[e];
            sum += frame_back[e];
            sum += frame_ahead[e];
            shared[e] = (sum + along[e]) * share;
        }
        const auto offsets = load(pass.offsets[step]);
        const auto send_along = [&](std::size_t d, const Costs& old, const Fields& there,
                                    Costs& out) FLUIDCARVE_INLINED {
            Costs part;
            // Any entry may be the one that counts as 0.
            const auto zero = shared[entries / 2] - old[entries / 2];
#pragma GCC unroll 8
            for (std::size_t e = 0; e < entries; ++e) part[e] = shared[e] - old[e] - zero;
            const Way way{(offsets & bit_of(forward, d, false)) != 0,
                          (offsets & bit_of(forward, d, true)) != 0, eight_of(pass.rigidity[d]),
                          weight};
            send<stepping>(part, way, edges ? pass.fields[step] : no_fields, there, out);
        };
        const auto keep = [&](const EightPlaces& has, Costs& sent) FLUIDCARVE_INLINED {
#pragma GCC unroll 8
            for (std::size_t e = 0; e < entries; ++e) sent[e] = has ? sent[e] : Eight{};
        };
        const auto next = forward ? step + 1 : step - 1;
        const bool has_next = next >= 0 && next < steps;
        const auto& of_next = edges && has_next ? pass.fields[next] : no_fields;
        send_along(0, along_ahead, of_next, along);
        // Where a line ends.
        if (step < static_cast<std::int32_t>(lanes) || step + 1 >= laterals) {
            const auto lateral = step - eight_places;
            keep(forward ? (lateral >= 0) & (lateral + 1 < laterals)
                         : (lateral > 0) & (lateral < laterals),
                 along);
        }
        if (forward) here.along[0] = along;
        else if (!first) pass.here[step - 1].along[0] = along;

        if constexpr (edges)
            send_along(1, aside_ahead, fields_aside<forward>(pass, step, of_next), aside);
        else send_along(1, aside_ahead, no_fields, aside);
        if (forward) {
            if (pass.slices_behind < lanes)
                keep(eight_places < static_cast<std::int32_t>(pass.slices_behind), aside);
            if (!pass.sends_to_block)
                for (std::size_t e = 0; e < entries; ++e)
                    aside[e] = eight_places < static_cast<std::int32_t>(lanes - 1) ? aside[e]
                                                                                   : aside_ahead[e];
            here.along[1] = aside;
        } else if (beside != nullptr && pass.sends_to_block) {
            for (std::size_t e = 0; e < entries; ++e) beside->along[1][e][lanes - 1] = aside[e][0];
        }

        if (!pass.sends_to_frame) continue;
        send_along(2, frame_ahead, edges ? pass.fields_of_frame[forward][step] : no_fields,
                   forward ? here.along[2] : of_frame->along[2]);
    }
}

template <Stepping stepping>
FLUIDCARVE_INLINE void pass_either(const Pass& pass, bool forward) {
    forward ? pass_block<stepping, true>(pass) : pass_block<stepping, false>(pass);
}
FLUIDCARVE_WIDE void pass_free(const Pass& pass, bool forward) {
    pass_either<Stepping::free>(pass, forward);
}
FLUIDCARVE_WIDE void pass_rigid(const Pass& pass, bool forward) {
    pass_either<Stepping::rigid>(pass, forward);
}
FLUIDCARVE_WIDE void pass_field(const Pass& pass, bool forward) {
    pass_either<Stepping::field>(pass, forward);
}

}  // namespace

bool SkewedMessages::fits(const Strip& strip) {
    const auto& columns = strip.columns();
    return strip.width() == entries && columns.slices() >= lanes && !columns.ring(0) &&
           !columns.ring(1) && !strip.protects();
}

SkewedMessages::SkewedMessages(const Strip& strip, const ColumnMessages* messages,
                               const KeptMemory& memory)
    : strip_(strip),
      size_{strip.columns().laterals(), strip.columns().slices(), strip.columns().frames()},
      blocks_((size_[1] + lanes - 1) / lanes),
      steps_(size_[0] + lanes - 1),
      messages_(memory.array<Messages>(steps_ * blocks_ * size_[2])),
      energies_(memory.array<Costs>(messages_.size())),
      fields_(memory.array<Fields>(strip.steps().has_field() ? messages_.size() : 0)),
      offsets_(memory.array<Offsets>(messages_.size())) {
    for_rows([&](std::size_t row) {
        for (std::size_t number = 0; number < steps_; ++number) {
            const Step step{size_, row / blocks_, row % blocks_, number};
            const auto at = row * steps_ + number;
            gather_messages(step, messages, messages_[at]);
            gather_energies(step, strip_.energies(0), energies_[at]);
            if (fields_.size() > 0) gather_fields(step, strip_.fields(0), fields_[at]);
        }
        find_offsets(strip_, row / blocks_, row % blocks_, {&offsets_[row * steps_], steps_});
    });
}

template <class Call>
void SkewedMessages::for_rows(const Call& call) const {
    tbb::parallel_for(std::size_t{0}, blocks_ * size_[2], call);
}

void SkewedMessages::pass(bool forward, int turns, const std::function<void()>& tick) {
    const std::array count{std::size_t{1}, blocks_, size_[2]};
    in_wavefront(
        count, tile(turns), [] { return 0; },
        [&](const Box& box, int) { pass_tile(box, forward, turns); }, [&](double) { tick(); });
}

std::array<std::size_t, 3> SkewedMessages::tile(int turns) const {
    if (strip_.columns().count() < least_shared_columns) return {1, blocks_, size_[2]};
    // Many frames let messages go far in a tile; it still stays in the memory of one processor.
    return {1, 1, turns > 1 ? std::size_t{8} : std::size_t{2}};
}

void SkewedMessages::pass_tile(const Box& tile, bool forward, int turns) {
    const auto& steps = strip_.steps();
    const float in_space = steps.lift(false, 0, 0), in_time = steps.lift(true, 0, 0);
    const auto lines = std::max<std::ptrdiff_t>(
        std::ranges::count_if(size_, [](std::size_t each) { return each > 1; }), 1);
    const auto begin = [&](std::size_t block, std::size_t t) {
        return (t * blocks_ + block) * steps_;
    };
    const auto at = [&](auto& array, std::size_t block, std::size_t t, bool is) {
        return is && array.size() > 0 ? array.data() + begin(block, t) : nullptr;
    };
    const auto blocks = tile.end[1] - tile.begin[1], frames = tile.end[2] - tile.begin[2];
    // Against the order of columns, tiles are counted from the end.
    const auto first_block = forward ? tile.begin[1] : blocks_ - tile.end[1],
               first_frame = forward ? tile.begin[2] : size_[2] - tile.end[2];
    for (int turn = 0; turn < turns; ++turn) {
        const bool on = forward == (turn % 2 == 0), last = turn + 1 == turns;
        for (std::size_t f = 0; f < frames; ++f)
            for (std::size_t b = 0; b < blocks; ++b) {
                const auto t = first_frame + (on ? f : frames - 1 - f),
                           block = first_block + (on ? b : blocks - 1 - b);
                const bool blocks_behind = block + 1 < blocks_, frames_behind = t + 1 < size_[2];
                const Pass pass{
                    .laterals = size_[0],
                    .lines = static_cast<float>(lines),
                    .rigidity = {in_space, in_space, in_time},
                    .weight = steps.has_field() ? steps.lift(false, 1, 0) - in_space : 0,
                    // What leaves the tile is sent once: until then the messages at its borders are
                    // those that come in.
                    .sends_to_block = last || b + 1 < blocks,
                    .sends_to_frame = (on ? frames_behind : t > 0) && (last || f + 1 < frames),
                    .slices_behind = size_[1] - 1 - lanes * block,
                    .here = &messages_[begin(block, t)],
                    .block_before = at(messages_, block - 1, t, block > 0),
                    .frame_before = at(messages_, block, t - 1, t > 0),
                    .energies = &energies_[begin(block, t)],
                    .offsets = &offsets_[begin(block, t)],
                    .fields = at(fields_, block, t, true),
                    .fields_of_block = {at(fields_, block - 1, t, block > 0),
                                        at(fields_, block + 1, t, blocks_behind)},
                    .fields_of_frame = {at(fields_, block, t - 1, t > 0),
                                        at(fields_, block, t + 1, frames_behind)},
                };
                if (steps.has_field()) pass_field(pass, on);
                else if (steps) pass_rigid(pass, on);
                else pass_free(pass, on);
            }
    }
}

void SkewedMessages::to_and_fro(int turns, const std::function<void()>& tick) {
    pass(true, turns, tick);
    pass(false, turns, tick);
}

void SkewedMessages::write(ColumnMessages* messages) const {
    for_rows([&](std::size_t row) {
        for (std::size_t number = 0; number < steps_; ++number)
            scatter_messages({size_, row / blocks_, row % blocks_, number},
                             messages_[row * steps_ + number], messages);
    });
}

}  // namespace fluidcarve
