#pragma once

#include "carve/seam/column_grid.h"
#include "carve/seam/seams.h"
#include "carve/seam/window.h"

#include <openvdb/Types.h>
#include <openvdb/math/Coord.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace fluidcarve {

class Joins;
class SmoothDisplacement;

/// One seam set in one frame, as a map from carved to original vertices along the carved axis:
/// `m(i)` of METHOD 4. Pairs of seams move only the entries between their two windows. A warp is
/// always smooth: it has displacements soft(), and no first_displaced().
/// Entries are positions along the axis. The space before is the one that the step carves. With an
/// anchor, the carved space may begin at another entry than the space before. The content of
/// carved entry `i` comes from entry `i + d`. Displacements `d` are in half vertices, since an
/// inserted entry stands between two.
class CarveStep {
public:
    /// @param t       index of the frame in seams.frames
    /// @param count   number of seams used, from the first; 1 for a warp
    /// @param origin  first vertex of the space before
    CarveStep(const Seams& seams, std::size_t t, std::size_t count,
              const std::array<int, 3>& origin = {});

    const ColumnGrid& columns() const { return columns_; }
    // Indices of the dimensions in a vertex's coordinates.
    int axis() const { return columns_.axis(); }
    int lateral_axis() const { return columns_.lateral_axis(); }
    int slice_axis() const { return columns_.slice_axis(); }
    /// Whether seams insert; of pairs, those of the first window; false for a warp.
    bool inserts() const { return inserts_; }
    bool paired() const { return paired_; }
    /// Whether seams are slabs (Seams::thickness); a slab's seams displace from the same entry.
    bool thick() const { return thick_; }
    bool warps() const { return !column_ends_.empty(); }  ///< whether the set is a warp
    /// Whether the carved axis is a ring: entry before() is entry 0 again.
    bool turns() const { return turns_; }
    int count() const { return static_cast<int>(count_); }  ///< number of seams; 0 for a warp
    int before() const { return before_; }  ///< vertices along the axis before the carve
    int after() const { return after_; }

    int origin() const { return origin_; }  ///< first entry of the space before
    int start() const { return start_; }    ///< first entry of the carved space
    int last_before() const { return origin_ + before_ - 1; }
    int last() const { return start_ + after() - 1; }
    /// First and last entry that the step may write.
    int low() const { return std::min(origin_, start_); }
    int high() const { return std::max(last_before(), last()); }
    /// In all columns, no entry below this moves.
    int first_moved() const { return first_moved_; }
    /// In all columns, no entry above this moves.
    int last_moved() const { return last_moved_; }
    /// Largest distances from an entry down and up to where its content comes from, vertices.
    int most_down() const { return most_down_; }
    int most_up() const { return most_up_; }

    /// A range of entries within which displacements change, and the displacements before and
    /// behind it, vertices.
    struct Span {
        Window entries;
        double before, behind;
    };
    /// The windows of the seams in the carved space, rising. Displacements change along the axis
    /// only within them.
    /// @param seams  the seams that the step was made of
    std::vector<Span> windows(const Seams& seams) const;

    /// Replaces displacements by whole vertices with smoothed ones.
    /// @param first, last  displacements are constant along the axis before `first` and behind
    ///   `last`
    void set_soft(std::shared_ptr<const SmoothDisplacement> soft, int first, int last);
    /// The smoothed displacements; null if whole vertices move.
    const SmoothDisplacement* soft() const { return soft_.get(); }

    /// Blends both sides of each seam. The smoothed displacements then apply to the slow part of
    /// values only (METHOD 10 "Joins").
    void set_joins(std::shared_ptr<const Joins> joins) { joins_ = std::move(joins); }
    /// The joins of faded seams; null if seams are not faded.
    const Joins* joins() const { return joins_.get(); }

    /// Whether the step carves or frees a point of its carved space.
    /// @param at  carved lattice coordinates
    bool holds(const openvdb::Vec3d& at) const {
        const double entry = at[axis()];
        return entry >= low() && entry <= high() && columns_.holds(at);
    }
    void fade_rims(double vertices) { rim_fade_ = vertices; }  ///< see CarveMap::fade_rims
    bool rims_fade() const { return rim_fade_ > 0; }
    /// Factor for displacements at a point, 0..1. Rises linearly from 0 at lateral rims and open
    /// ends to 1 where the rims' fade ends. Always 1 without such a fade.
    double rim_scale(const openvdb::Vec3d& at) const {
        if (rim_fade_ == 0) return 1;
        const auto from_rim = [this](double x, int size) {
            return size == 1 ? rim_fade_ : std::min(x, size - 1 - x);
        };
        const auto& of = columns_;
        const double lateral = of.around ? rim_fade_
                                         : from_rim(at[of.lateral_axis()] - of.first_lateral,
                                                    of.laterals),
                     slice = of.closed ? rim_fade_
                                       : from_rim(at[of.slice_axis()] - of.first_slice, of.slices);
        return std::min(1.0, std::min(lateral, slice) / rim_fade_);
    }
    /// An interval along the axis, entries.
    struct Ends {
        double begin, end;
    };
    /// The carved space in the column of a point. The entries that a removal frees, or an
    /// insertion adds, are scaled too. A warp's ends are the carved positions of the column's
    /// first and last vertex; if the warp moves them, they lie half a vertex further out.
    /// @param at     carved lattice coordinates, held
    /// @param scale  rim_scale(at)
    Ends ends(const openvdb::Vec3d& at, double scale) const {
        if (warps()) return warped_ends(at, scale);
        return {origin_ + scale * (start_ - origin_),
                last_before() + scale * (last() - last_before())};
    }
    /// Whether a point that the step holds lies in its carved space.
    bool carves(const openvdb::Vec3d& at, double scale) const {
        const double u = at[axis()];
        if (u >= common_.begin && u <= common_.end) return true;
        const auto [begin, end] = ends(at, scale);
        return u >= begin && u <= end;
    }
    /// Whether the step frees a point that it holds but does not carve: it lies in the space
    /// before. Otherwise the point stays.
    bool frees(const openvdb::Vec3d& at) const {
        return at[axis()] >= origin_ && at[axis()] <= last_before();
    }
    /// Whether the step may free some point of a range along the axis.
    bool may_free(double first, double last) const {
        return (common_.begin > origin_ && first < common_.begin) ||
               (common_.end < last_before() && last > common_.end);
    }
    /// The part of the space before that lies in the carved space in all columns.
    const Ends& common() const { return common_; }
    /// Clamps a source to the space before. A smoothed map may lead beyond its ends; it then reads
    /// at the ends.
    double clamped(double source) const {
        return std::clamp(source, static_cast<double>(origin_), static_cast<double>(last_before()));
    }
    /// The source of a point at `u` if rims fade: `source`, without a fade, is moved towards `u`
    /// and stays in the lattice.
    /// @param scale  rim_scale() there
    double faded_source(double u, double source, double scale) const {
        return scale < 1 ? clamped(u + scale * (source - u)) : source;
    }

    /// For each seam of a column, the first carved entry that the seam displaces; rising. For an
    /// insertion this is the new entry; if slabs are doubled, the first entry of the second copy.
    /// Of pairs, seams of the first window come first.
    /// @param column  ColumnGrid::index
    std::span<const std::uint16_t> first_displaced(std::size_t column) const {
        const auto all = (paired_ ? 2 : 1) * count_;
        return {first_displaced_.data() + column * all, all};
    }
    std::span<const std::uint16_t> first_displaced(int lateral, int slice) const {
        return first_displaced(columns_.index(lateral, slice));
    }
    /// Those of a vertex's column, which must exist.
    std::span<const std::uint16_t> first_displaced(const openvdb::Coord& vertex) const {
        return first_displaced(vertex[lateral_axis()], vertex[slice_axis()]);
    }
    /// Number of a column's first displaced entries that are at most `entry`.
    static std::size_t passed(int entry, std::span<const std::uint16_t> all) {
        // Shortcut: most entries lie below or above all of them.
        if (all.empty() || entry < all.front()) return 0;
        if (entry >= all.back()) return all.size();
        return static_cast<std::size_t>(std::ranges::upper_bound(all, entry) - all.begin());
    }
    /// Displacement of an entry without smoothing, half vertices.
    /// @param entry   start() to last()
    /// @param passed  passed(entry, all)
    /// @param all     first_displaced() of the column
    int displacement(int entry, std::size_t passed, std::span<const std::uint16_t> all) const {
        // The seams of the second window undo what those of the first did.
        const int back = paired_ ? std::max(static_cast<int>(passed) - count(), 0) : 0;
        const int ahead = 2 * (static_cast<int>(passed) - 2 * back);
        const bool at_new =
            !thick_ && passed > 0 && inserts_ == (back == 0) && all[passed - 1] == entry;
        return (inserts_ ? -ahead : ahead) + (at_new ? 1 : 0) + 2 * (origin_ - start_);
    }
    /// The same in an existing column.
    int displacement(int entry, int lateral, int slice) const {
        const auto all = first_displaced(lateral, slice);
        return displacement(entry, passed(entry, all), all);
    }

private:
    /// Vertices by which the seams of the first window lengthen it.
    int growth() const { return inserts_ ? count() : -count(); }
    void find_first_displaced(const Seams& seams, std::size_t t);
    void find_displacements(const Warp& warp, std::size_t t);
    Ends warped_ends(const openvdb::Vec3d& at, double scale) const;

    ColumnGrid columns_;
    int before_, after_, origin_, start_;
    bool inserts_, paired_, thick_, turns_;
    std::size_t count_;
    int first_moved_, last_moved_, most_down_, most_up_;
    double rim_fade_ = 0;                         ///< vertices; 0: none
    std::vector<std::uint16_t> first_displaced_;  ///< `[column][seam]`
    Ends common_;
    std::vector<Ends> column_ends_;  ///< `[column]`: where a warp moves the first and the last
                                     ///< vertex; empty for seams
    std::shared_ptr<const SmoothDisplacement> soft_;
    std::shared_ptr<const Joins> joins_;
};

}  // namespace fluidcarve
