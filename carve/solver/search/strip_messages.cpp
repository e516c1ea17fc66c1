#include "carve/solver/search/strip_messages.h"

#include "carve/base/each_in_parallel.h"
#include "carve/solver/search/protection.h"
#include "carve/solver/search/row_pass.h"
#include "carve/solver/search/wavefront.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

namespace fluidcarve {

namespace {

/// Columns along each dimension that a thread visits one after the other. Long rows are read
/// faster; a few frames leave too little to share.
std::array<std::size_t, 3> box_of_messages(const std::array<std::size_t, 3>& size) {
    if (size[0] * size[1] * size[2] < least_shared_columns) return size;
    if (size[2] < 8) return {16, 8, 4};
    return {128, 8, 2};
}

/// @param begin, end  along the lateral dimension, in the order of the pass
/// @param k, t        of the row, likewise
template <bool edges, bool forward, bool plain>
FLUIDCARVE_INLINE void pass_row(const MessagePass& pass, std::size_t begin, std::size_t end,
                                std::size_t k, std::size_t t) {
    RowPass<edges, forward, plain>(pass, k, t).run(begin, end);
}

template <bool edges>
FLUIDCARVE_INLINE void pass_any_row(const MessagePass& pass, std::size_t begin, std::size_t end,
                                    std::size_t k, std::size_t t) {
    const bool plain = !pass.rings && !pass.holes && pass.taken == nullptr;
    if (pass.forward)
        plain ? pass_row<edges, true, true>(pass, begin, end, k, t)
              : pass_row<edges, true, false>(pass, begin, end, k, t);
    else
        plain ? pass_row<edges, false, true>(pass, begin, end, k, t)
              : pass_row<edges, false, false>(pass, begin, end, k, t);
}

FLUIDCARVE_WIDE void pass_free(const MessagePass& pass, std::size_t begin, std::size_t end,
                               std::size_t k, std::size_t t) {
    pass_any_row<false>(pass, begin, end, k, t);
}
FLUIDCARVE_WIDE void pass_edges(const MessagePass& pass, std::size_t begin, std::size_t end,
                                std::size_t k, std::size_t t) {
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
    const auto column = few.at(at.lateral, at.slice, at.t);
    const std::array<std::size_t, 3> place{at.lateral, at.slice, at.t},
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
    each_in_parallel(few.count(), 256, [&](std::size_t c) {
        interpolate(coarse.strip_, coarse.messages_.data(), few.place(c), strip_, window.first,
                    messages_.data());
    });
}

void StripMessages::pass(bool forward, const Origin& origin, const std::vector<std::uint16_t>& seam,
                         std::vector<std::uint16_t>* taken, const std::function<void()>& check) {
    const auto& columns = strip_.columns();
    const auto& steps = strip_.steps();
    const std::array size{columns.laterals(), columns.slices(), columns.frames()};
    const MessagePass work{
        columns,
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
        [&](const ColumnBox& box, int) {
            for (auto t = box.begin[2]; t < box.end[2]; ++t)
                for (auto k = box.begin[1]; k < box.end[1]; ++k) {
                    if (work.fields != nullptr) pass_edges(work, box.begin[0], box.end[0], k, t);
                    else pass_free(work, box.begin[0], box.end[0], k, t);
                }
        },
        [&](double) { check(); });
}

void StripMessages::forget(const Origin& origin) {
    const auto& columns = strip_.columns();
    const std::array size{columns.laterals(), columns.slices()};
    for (std::size_t d = 0; d < 2; ++d) {
        if (!columns.ring(d)) continue;
        const auto last = (origin[d] + size[d] - 1) % size[d];
        for (std::size_t c = 0; c < messages_.size(); ++c)
            if (const auto at = columns.place(c); (d == 0 ? at.lateral : at.slice) == last)
                messages_[c].along[d] = Eight{};
    }
}

void StripMessages::improve(std::vector<std::uint16_t>& seam, int passes, bool goes_on,
                            const std::function<void()>& check) {
    const auto& columns = strip_.columns();
    if (!columns.ring(0) && !columns.ring(1)) return improve(seam, passes, {0, 0}, goes_on, check);
    // Seams around a ring cost most beside the column at which messages begin. So they begin at the
    // middle, then at column 0.
    const Origin middle{columns.ring(0) ? columns.laterals() / 2 : 0,
                        columns.ring(1) ? columns.slices() / 2 : 0};
    improve(seam, passes, middle, true, check);
    forget(middle);
    forget({0, 0});
    improve(seam, passes, {0, 0}, goes_on, check);
}

void StripMessages::improve(std::vector<std::uint16_t>& seam, int passes, const Origin& origin,
                            bool goes_on, const std::function<void()>& check) {
    auto found = seam;
    for (int n = 0; n < passes; ++n) {
        const bool last = n + 1 == passes;
        pass(true, origin, seam, last ? &found : nullptr, check);
        if (!last || goes_on) pass(false, origin, seam, nullptr, check);
    }
    if (strip_.protects())
        found = moved_aside(
            strip_.columns(), found, strip_.band(),
            [&](std::size_t c, int entry) { return strip_.energy(c, entry); }, strip_.steps());
    if (strip_.energy(found) < strip_.energy(seam)) seam = std::move(found);
}

}  // namespace fluidcarve
