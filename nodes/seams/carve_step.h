#pragma once

#include "nodes/seams/seams.h"
#include "nodes/seams/window.h"

#include <openvdb/Types.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace fluidcarve {

class SmoothDisplacement;

/// One seam set in one frame as a map from carved to original vertices along the carved axis: `m(i)` of METHOD 4. Seams
/// that come in pairs move what is between the two windows, and nothing beyond.
/// Entries are places along the axis: an anchor lets the carved space begin elsewhere than the space before, so that the content of
/// entry `i` comes from entry `i + d`. Displacements `d` are in half vertices, since an inserted entry stands between two.
class CarveStep {
public:
    /// @param t       the frame's place in seams.frames
    /// @param count   how many of the seams, from the first
    /// @param origin  where the space before begins, along u and v
    CarveStep(const Seams& seams, std::size_t t, std::size_t count, const std::array<int, 2>& origin = {});

    int axis() const { return axis_; }  ///< 0 (u) or 1 (v)
    int lateral_axis() const { return 1 - axis_; }
    bool inserts() const { return inserts_; }  ///< of pairs, the first
    bool paired() const { return paired_; }
    bool closed() const { return closed_; }  ///< plane slices() is plane 0
    int count() const { return static_cast<int>(count_); }
    int before() const { return before_; }  ///< vertices along the axis
    int after() const { return paired_ ? before_ : inserts_ ? before_ + count() : before_ - count(); }
    int laterals() const { return laterals_; }
    int first_lateral() const { return first_lateral_; }
    int last_lateral() const { return first_lateral_ + laterals_ - 1; }
    int slices() const { return slices_; }

    int origin() const { return origin_; }  ///< first entry of the space before
    int start() const { return start_; }    ///< first entry of the carved space
    int last_before() const { return origin_ + before_ - 1; }
    int last() const { return start_ + after() - 1; }
    /// Entries that the step may write: first and last.
    int low() const { return std::min(origin_, start_); }
    int high() const { return std::max(last_before(), last()); }
    /// No entry below this is moved in any column.
    int first_moved() const { return first_moved_; }
    /// No entry above this is moved in any column.
    int last_moved() const { return last_moved_; }

    /// Entries in which displacements change from one value to another, and those values, vertices.
    struct Span {
        Window entries;
        double before, behind;
    };
    /// The windows of the carved space, in which alone displacements change along the axis; rising.
    /// @param seams  what the step was made of
    std::vector<Span> windows(const Seams& seams) const;

    /// Replaces whole displacements by smoothed ones.
    /// @param first, last  entries before and behind which nothing changes along the axis
    void set_soft(std::shared_ptr<const SmoothDisplacement> soft, int first, int last);
    /// The smoothed displacements; null: whole vertices move.
    const SmoothDisplacement* soft() const { return soft_.get(); }

    /// Whether the step carves at a point of its carved space, or frees it.
    bool holds(const openvdb::Vec3d& at) const {
        const double u = at[axis_], v = at[1 - axis_];
        return u >= low() && u <= high() && v >= first_lateral_ && v <= last_lateral();
    }
    void fade(double vertices) { fade_ = vertices; }  ///< of CarveMap::fade
    bool fades() const { return fade_ > 0; }
    /// By how much displacements are scaled at a point: linearly from 0 at lateral rims and open ends to 1 `fade` vertices
    /// away from them. 1 everywhere without a fade.
    double scale(const openvdb::Vec3d& at) const {
        if (fade_ == 0) return 1;
        const auto from_rim = [this](double x, int size) { return size == 1 ? fade_ : std::min(x, size - 1 - x); };
        return std::min(1.0, std::min(from_rim(at[1 - axis_] - first_lateral_, laterals_), closed_ ? fade_ : from_rim(at.z(), slices_)) / fade_);
    }
    /// Where the carved space begins and ends along the axis: what a removal frees, or an insertion adds, is scaled too.
    double begin(double scale) const { return origin_ + scale * (start_ - origin_); }
    double end(double scale) const { return last_before() + scale * (last() - last_before()); }
    /// Whether a point that the step holds lies in its carved space.
    bool carves(double u, double scale) const { return u >= begin(scale) && u <= end(scale); }
    /// The place from which a smoothed map reads: where it leads beyond the ends of the space before, those hold.
    double held(double source) const { return std::clamp(source, static_cast<double>(origin_), static_cast<double>(last_before())); }
    /// The entry `source`, from which a point at `u` on the axis comes where nothing is scaled, drawn towards it; never from
    /// beyond the lattice.
    double drawn(double u, double source, double scale) const { return scale < 1 ? held(u + scale * (source - u)) : source; }
    bool has_column(int lateral, int k) const { return lateral >= first_lateral_ && lateral <= last_lateral() && k >= 0 && k < slices_; }
    /// Per seam of the column, rising, the carved entry from which on it displaces; for an insertion that is its new
    /// entry. Of pairs, those of the first window come first.
    /// @param k  may be slices() if closed()
    std::span<const std::uint16_t> bounds(int lateral, int k) const {
        if (k == slices_) k = 0;
        const auto all = paired_ ? 2 * count_ : count_;
        return {bounds_.data() + (static_cast<std::size_t>(lateral - first_lateral_) + static_cast<std::size_t>(laterals_) * static_cast<std::size_t>(k)) * all,
                all};
    }
    /// How many bounds of a column are not above an entry.
    static std::size_t passed(int entry, std::span<const std::uint16_t> all) {
        // Most entries lie below or above all.
        if (all.empty() || entry < all.front()) return 0;
        if (entry >= all.back()) return all.size();
        return static_cast<std::size_t>(std::upper_bound(all.begin(), all.end(), entry) - all.begin());
    }
    /// Half vertices, as without smoothing. @param entry  start() to last()
    int displacement(int entry, std::size_t passed, std::span<const std::uint16_t> all) const {
        // The seams of the second window undo what those of the first did.
        const int back = paired_ ? std::max(static_cast<int>(passed) - count(), 0) : 0;
        const int ahead = 2 * (static_cast<int>(passed) - 2 * back);
        const bool at_new = passed > 0 && inserts_ == (back == 0) && all[passed - 1] == entry;
        return (inserts_ ? -ahead : ahead) + (at_new ? 1 : 0) + 2 * (origin_ - start_);
    }
    /// The same in a column that there is.
    int displacement(int entry, int lateral, int k) const {
        const auto all = bounds(lateral, k);
        return displacement(entry, passed(entry, all), all);
    }

private:
    int axis_, before_, laterals_, slices_, first_lateral_, origin_, start_;
    bool inserts_, paired_, closed_;
    std::size_t count_;
    int first_moved_, last_moved_;
    double fade_ = 0;                    ///< vertices; 0: none
    std::vector<std::uint16_t> bounds_;  ///< `[column][seam]`
    std::shared_ptr<const SmoothDisplacement> soft_;
};

}  // namespace fluidcarve
