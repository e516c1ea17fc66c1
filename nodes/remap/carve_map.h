#pragma once

#include "nodes/seam/seams.h"

#include <openvdb/Types.h>
#include <openvdb/math/BBox.h>
#include <openvdb/math/Coord.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace fluidcarve {

/// One seam set in one frame as a map from carved to original vertices along the carved axis: `m(i)` of METHOD 4. Seams
/// that come in pairs move what is between the two windows, and nothing beyond.
/// Displacements `d = m - i` are in half vertices, since an inserted entry stands between two.
class CarveStep {
public:
    /// @param t      the frame's place in seams.frames
    /// @param count  how many of the seams, from the first
    CarveStep(const Seams& seams, std::size_t t, std::size_t count);

    int axis() const { return axis_; }  ///< 0 (u) or 1 (v)
    int lateral_axis() const { return 1 - axis_; }
    bool inserts() const { return inserts_; }  ///< of pairs, the first
    bool paired() const { return paired_; }
    bool closed() const { return closed_; }  ///< plane slices() is plane 0
    int count() const { return static_cast<int>(count_); }
    int before() const { return before_; }  ///< vertices along the axis
    int after() const { return paired_ ? before_ : inserts_ ? before_ + count() : before_ - count(); }
    int reach() const { return std::max(before_, after()); }  ///< vertices that the step may write
    int laterals() const { return laterals_; }
    int slices() const { return slices_; }
    /// No entry below this is moved in any column.
    int first_moved() const { return first_moved_; }
    /// No entry above this is moved in any column.
    int last_moved() const { return last_moved_; }

    /// Whether the step carves at a point of its carved space, or frees it.
    bool holds(const openvdb::Vec3d& at) const {
        const double u = at[axis_], v = at[1 - axis_];
        return u >= 0 && u <= reach() - 1 && v >= 0 && v <= laterals_ - 1;
    }
    void fade(double vertices) { fade_ = vertices; }  ///< of CarveMap::fade
    bool fades() const { return fade_ > 0; }
    /// By how much displacements are scaled at a point: linearly from 0 at lateral rims and open ends to 1 `fade` vertices
    /// away from them. 1 everywhere without a fade.
    double scale(const openvdb::Vec3d& at) const {
        if (fade_ == 0) return 1;
        const auto from_rim = [this](double x, int size) { return size == 1 ? fade_ : std::min(x, size - 1 - x); };
        return std::min(1.0, std::min(from_rim(at[1 - axis_], laterals_), closed_ ? fade_ : from_rim(at.z(), slices_)) / fade_);
    }
    /// Where the carved space ends along the axis: what a removal frees, or an insertion adds, is scaled too.
    double end(double scale) const { return before_ - 1 + scale * (after() - before_); }
    /// The entry `source`, from which a point at `u` on the axis comes where nothing is scaled, drawn towards it; never from
    /// beyond the lattice.
    double drawn(double u, double source, double scale) const { return scale < 1 ? std::min(u + scale * (source - u), before_ - 1.0) : source; }
    bool has_column(int lateral, int k) const { return lateral >= 0 && lateral < laterals_ && k >= 0 && k < slices_; }
    /// Per seam of the column, rising, the carved entry from which on it displaces; for an insertion that is its new
    /// entry. Of pairs, those of the first window come first.
    /// @param k  may be slices() if closed()
    std::span<const std::uint16_t> bounds(int lateral, int k) const {
        if (k == slices_) k = 0;
        const auto all = paired_ ? 2 * count_ : count_;
        return {bounds_.data() + (static_cast<std::size_t>(lateral) + static_cast<std::size_t>(laterals_) * static_cast<std::size_t>(k)) * all, all};
    }
    /// How many bounds of a column are not above an entry.
    static std::size_t passed(int entry, std::span<const std::uint16_t> all) {
        // Most entries lie below or above all.
        if (all.empty() || entry < all.front()) return 0;
        if (entry >= all.back()) return all.size();
        return static_cast<std::size_t>(std::upper_bound(all.begin(), all.end(), entry) - all.begin());
    }
    /// Half vertices. @param entry  0 to after() - 1
    int displacement(int entry, std::size_t passed, std::span<const std::uint16_t> all) const {
        // The seams of the second window undo what those of the first did.
        const int back = paired_ ? std::max(static_cast<int>(passed) - count(), 0) : 0;
        const int ahead = 2 * (static_cast<int>(passed) - 2 * back);
        const bool at_new = passed > 0 && inserts_ == (back == 0) && all[passed - 1] == entry;
        return (inserts_ ? -ahead : ahead) + (at_new ? 1 : 0);
    }
    /// The same in a column that there is.
    int displacement(int entry, int lateral, int k) const {
        const auto all = bounds(lateral, k);
        return displacement(entry, passed(entry, all), all);
    }

private:
    int axis_, before_, laterals_, slices_;
    bool inserts_, paired_, closed_;
    std::size_t count_;
    int first_moved_, last_moved_;
    double fade_ = 0;                    ///< vertices; 0: none
    std::vector<std::uint16_t> bounds_;  ///< `[column][seam]`
};

/// A chain of seam sets in one frame (METHOD 4): each is carved from what those before it leave. To find what stands
/// at a carved vertex, the last step is asked first. A vertex that no step's lattice holds stays where it is; one that
/// a removal frees at the positive end is background.
class CarveMap {
public:
    /// @param sets   in the order of carving
    /// @param frame  a frame number
    /// @param count  how many seams of the last set; nothing: all
    /// @throws Failure if a set belongs to another lattice or misses the frame, shapes do not chain, or count is too high
    CarveMap(const Lattice& lattice, const std::vector<std::shared_ptr<const Seams>>& sets, int frame, std::optional<std::size_t> count);

    /// Lets displacements go linearly to 0 towards lateral rims and open ends, where they else end with a jump (METHOD 4,
    /// "Tears"): what stands at a point comes from `u + s (m - u)` instead of `m`, `s` from 0 to 1 (CarveStep::scale). `m`
    /// never falls along the axis, so neither does this: the map does not fold. What a removal frees, or an insertion adds
    /// beyond the lattice, shrinks by `s` too. As far as `vertices` from rims and ends
    /// and beyond, nothing changes.
    /// @param vertices  above 0, over which they go to 0
    /// @throws Failure if the lattice is so thin that no vertex would move as far as asked for
    void fade(double vertices);
    bool fades() const;

    /// Sets without seams are left out.
    const std::vector<CarveStep>& steps() const { return steps_; }
    bool empty() const { return steps_.empty(); }
    /// Vertices per dimension that carving may write: the lattice and what insertions add along the way.
    const std::array<int, 3>& reach() const { return reach_; }

    /// What a box of carved lattice coordinates is made of.
    /// @param range  grows to hold all coordinates that its points come from, itself included
    /// @param frees  set if part of it becomes background
    /// @return false if nothing in it moves
    bool trace(openvdb::BBoxd& range, bool& frees) const;
    /// A box of lattice coordinates outside which nothing moves.
    openvdb::BBoxd moved() const;

private:
    std::vector<CarveStep> steps_;
    std::array<int, 3> reach_;
};

}  // namespace fluidcarve
