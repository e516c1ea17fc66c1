#include "nodes/seams/carve_step.h"

#include "graph/text/problem.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

namespace fluidcarve {

namespace {

/// Collects one column's entries of the first `count` seams of a window.
/// @param sorted  becomes their original indices, rising
void sort_entries(const std::vector<Seams::Seam>& seams, Seams::Kind kind, std::size_t count, std::size_t column, std::vector<std::uint16_t>& entries,
                  std::vector<std::uint16_t>& sorted) {
    entries.clear();
    for (std::size_t n = 0; n < count; ++n) entries.push_back(seams[n].at[column]);
    if (kind == Seams::Kind::remove) return to_original(entries, sorted);
    sorted = entries;
    std::sort(sorted.begin(), sorted.end());
}

}  // namespace

CarveStep::CarveStep(const Seams& seams, std::size_t t, std::size_t count, const std::array<int, 2>& origin)
    : axis_(static_cast<int>(seams.axis)),
      before_(seams.carved()),
      laterals_(seams.lateral()),
      slices_(seams.shape[2]),
      first_lateral_(origin[static_cast<std::size_t>(1 - axis_)]),
      origin_(origin[static_cast<std::size_t>(axis_)]),
      start_(origin_ + seams.shift_after(count)),
      inserts_(seams.kind == Seams::Kind::insert),
      paired_(seams.paired()),
      closed_(seams.closed),
      around_(seams.around),
      count_(count),
      bounds_((paired_ ? 2 : 1) * count * seams.columns_per_frame()) {
    if (high() > most_vertices) throw Failure(fmt::format("{} vertices along {} are more than {}", high() + 1, to_text(seams.axis), most_vertices + 1));
    const auto columns = seams.columns_per_frame();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, columns, 1024), [&](const tbb::blocked_range<std::size_t>& range) {
        std::vector<std::uint16_t> entries, sorted;
        for (auto c = range.begin(); c < range.end(); ++c) {
            auto* out = bounds_.data() + c * (bounds_.size() / columns);
            const auto add = [&](const std::vector<Seams::Seam>& window, bool inserts, int shift) {
                sort_entries(window, inserts ? Seams::Kind::insert : Seams::Kind::remove, count, t * columns + c, entries, sorted);
                // n removals come before the n-th removed entry. The n-th new entry stands behind its original and n other new ones.
                for (int n = 0; n < static_cast<int>(count); ++n) *out++ = static_cast<std::uint16_t>(shift + (inserts ? sorted[n] + n + 1 : sorted[n] - n));
            };
            add(seams.seams, inserts_, start_);
            if (paired_) add(seams.pairs, !inserts_, start_ + growth());
        }
    });
    first_moved_ = start_ == origin_ ? high() + 1 : low();
    last_moved_ = paired_ ? 0 : high();
    for (std::size_t c = 0; c < columns && count > 0; ++c) {
        const auto* const column = bounds_.data() + c * (bounds_.size() / columns);
        first_moved_ = std::min<int>(first_moved_, column[0]);
        // Entries from the last removal on, or behind the last new entry, do not move.
        if (paired_) last_moved_ = std::max<int>(last_moved_, column[2 * count - 1] - (inserts_ ? 1 : 0));
    }
}

void CarveStep::set_soft(std::shared_ptr<const SmoothDisplacement> soft, int first, int last) {
    soft_ = std::move(soft);
    first_moved_ = start_ == origin_ ? first + 1 : low();
    if (paired_) last_moved_ = last - 1;
}

std::vector<CarveStep::Span> CarveStep::windows(const Seams& seams) const {
    const double whole = origin_ - start_, net = -growth();
    if (!paired_) {
        const auto window = seams.window.value_or(seams.whole_window());
        return {{{start_ + window.first, start_ + window.last + growth()}, whole, whole + net}};
    }
    std::array<Window, 2> out{Window{high(), low()}, Window{high(), low()}};
    if (seams.window && seams.pair_window) {
        const int moved = start_ + growth();
        out = {Window{start_ + seams.window->first, start_ + seams.window->last + growth()},
               Window{moved + seams.pair_window->first, moved + seams.pair_window->last - growth()}};
    } else {
        // A file may state no windows. They then begin and end where the seams do.
        for (std::size_t c = 0; c < bounds_.size(); c += 2 * count_)
            for (std::size_t n = 0; n < 2; ++n) {
                out[n].first = std::min<int>(out[n].first, bounds_[c + n * count_]);
                out[n].last = std::max<int>(out[n].last, bounds_[c + (n + 1) * count_ - 1]);
            }
    }
    return {{out[0], 0, net}, {out[1], net, 0}};
}

}  // namespace fluidcarve
