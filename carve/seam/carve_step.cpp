#include "carve/seam/carve_step.h"

#include "carve/base/failure.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace fluidcarve {

namespace {

/// Collects one column's entries of the first `count` seams of a window.
/// @param sorted  becomes their original indices, rising
void sort_entries(const std::vector<Seams::Seam>& seams, Seams::Kind kind, std::size_t count,
                  std::size_t column, std::vector<std::uint16_t>& entries,
                  std::vector<std::uint16_t>& sorted) {
    entries.clear();
    for (std::size_t n = 0; n < count; ++n) entries.push_back(seams[n].at[column]);
    if (kind == Seams::Kind::remove) return to_original(entries, sorted);
    sorted = entries;
    std::ranges::sort(sorted);
}

/// A doubled slab in one column.
struct Doubled {
    int behind;    ///< original entry behind the slab: there the second copy begins
    int vertices;  ///< of the slab that are doubled
};

/// The slabs that the first `count` insertions double in a column, rising.
void sort_slabs(const Seams& set, const std::vector<Seams::Seam>& seams, std::size_t count,
                std::size_t column, std::vector<Doubled>& slabs) {
    slabs.clear();
    const auto thickness = static_cast<std::size_t>(set.thickness);
    for (std::size_t n = 0; n < count; n += thickness) {
        const int vertices = static_cast<int>(std::min(thickness, count - n));
        slabs.push_back({seams[n].at[column] + vertices, vertices});
    }
    std::ranges::stable_sort(slabs, {}, &Doubled::behind);
}

/// Writes the bounds of the first seams of windows, column by column.
class BoundsWriter {
public:
    BoundsWriter(const Seams& seams, std::size_t count) : seams_(seams), count_(count) {}

    /// @param shift  what lies before the window moves by so many entries
    /// @return behind what was written
    std::uint16_t* write(const std::vector<Seams::Seam>& window, bool inserts, int shift,
                         std::size_t column, std::uint16_t* out) {
        if (seams_.thick() && inserts) {
            // A slab's second copy stands behind the slab and the copies of those before it.
            sort_slabs(seams_, window, count_, column, slabs_);
            for (int before = 0; const auto& slab : slabs_) {
                out = std::fill_n(out, slab.vertices,
                                  static_cast<std::uint16_t>(shift + slab.behind + before));
                before += slab.vertices;
            }
            return out;
        }
        sort_entries(window, inserts ? Seams::Kind::insert : Seams::Kind::remove, count_, column,
                     entries_, sorted_);
        // n removals come before the n-th removed entry. The n-th new entry stands behind its
        // original and n other new ones.
        for (int n = 0; n < static_cast<int>(count_); ++n) {
            const int entry = sorted_[static_cast<std::size_t>(n)];
            *out++ = static_cast<std::uint16_t>(shift + (inserts ? entry + n + 1 : entry - n));
        }
        return out;
    }

private:
    const Seams& seams_;
    const std::size_t count_;
    std::vector<std::uint16_t> entries_, sorted_;
    std::vector<Doubled> slabs_;
};

}  // namespace

CarveStep::CarveStep(const Seams& seams, std::size_t t, std::size_t count,
                     const std::array<int, 3>& origin)
    : columns_(seams, origin),
      before_(seams.before()),
      after_(seams.shape_after(count)[dimension(seams.axis)]),
      origin_(origin[dimension(seams.axis)]),
      start_(origin_ + seams.shift_after(count)),
      inserts_(!seams.warp && seams.kind == Seams::Kind::insert),
      paired_(seams.paired()),
      thick_(seams.thick()),
      turns_(seams.closed && !columns_.closed),
      count_(seams.warp ? 0 : count) {
    if (high() > most_vertices)
        throw Failure(fmt::format("{} vertices along {} are more than {}", high() + 1,
                                  to_text(seams.axis), most_vertices + 1));
    if (seams.warp) find_displacements(*seams.warp, t);
    else find_first_displaced(seams, t);
}

void CarveStep::find_first_displaced(const Seams& seams, std::size_t t) {
    const auto columns = seams.columns_per_frame();
    first_displaced_.resize((paired_ ? 2 : 1) * count_ * columns);
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, columns, 1024),
        [&](const tbb::blocked_range<std::size_t>& range) {
            BoundsWriter writer(seams, count_);
            for (auto c = range.begin(); c < range.end(); ++c) {
                const auto column = t * columns + c;
                auto* const out =
                    writer.write(seams.seams, inserts_, start_, column,
                                 first_displaced_.data() + c * (first_displaced_.size() / columns));
                if (paired_) writer.write(seams.pairs, !inserts_, start_ + growth(), column, out);
            }
        });
    first_moved_ = start_ == origin_ ? high() + 1 : low();
    last_moved_ = paired_ ? 0 : high();
    for (std::size_t c = 0; c < columns && count_ > 0; ++c) {
        const auto* const column =
            first_displaced_.data() + c * (first_displaced_.size() / columns);
        first_moved_ = std::min<int>(first_moved_, column[0]);
        // Entries from the last removal on, or behind the last new entry, do not move.
        if (paired_)
            last_moved_ = std::max<int>(last_moved_, column[2 * count_ - 1] - (inserts_ ? 1 : 0));
    }
    const int shift = start_ - origin_;
    most_down_ = std::max(0, shift + (inserts_ ? count() : 0));
    most_up_ = std::max(0, (inserts_ ? 0 : count()) - shift);
    common_ = {static_cast<double>(std::max(origin_, start_)),
               static_cast<double>(std::min(last_before(), last()))};
}

CarveStep::Ends CarveStep::warped_ends(const openvdb::Vec3d& at, double scale) const {
    const auto [columns, lateral, slice] = columns_.cell(at);
    const auto mix = [](const Ends& a, const Ends& b, double part) {
        return Ends{a.begin + part * (b.begin - a.begin), a.end + part * (b.end - a.end)};
    };
    const auto moved = mix(mix(column_ends_[columns[0]], column_ends_[columns[1]], lateral),
                           mix(column_ends_[columns[2]], column_ends_[columns[3]], lateral), slice);
    const double first = scale * (moved.begin - origin_),
                 last = scale * (moved.end - last_before());
    constexpr double half = 0.5;
    return {origin_ + first - std::min(half, std::abs(first)),
            last_before() + last + std::min(half, std::abs(last))};
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
        out = {
            Window{start_ + seams.window->first, start_ + seams.window->last + growth()},
            Window{moved + seams.pair_window->first, moved + seams.pair_window->last - growth()}};
    } else {
        // A file may state no windows. Then the seams' first and last entries are the windows.
        for (std::size_t c = 0; c < first_displaced_.size(); c += 2 * count_)
            for (std::size_t n = 0; n < 2; ++n) {
                out[n].first = std::min<int>(out[n].first, first_displaced_[c + n * count_]);
                out[n].last =
                    std::max<int>(out[n].last, first_displaced_[c + (n + 1) * count_ - 1]);
            }
    }
    return {{out[0], 0, net}, {out[1], net, 0}};
}

}  // namespace fluidcarve
