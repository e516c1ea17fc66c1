#include "carve/remap/voxels/carve_block.h"

#include "carve/lattice/snap.h"
#include "carve/seam/joins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <tuple>
#include <utility>

namespace fluidcarve {

template <class Column>
void CarveBlock::Table::each_column(const CarveStep& step, const Column& column) const {
    for (int k = first[2]; k < first[2] + size[2]; ++k)
        for (int j = first[1]; j < first[1] + size[1]; ++j)
            column(step.columns().index_within(j, k));
}

void CarveBlock::Table::fill_smooth(const CarveStep& step) {
    const auto& soft = *step.soft();
    smooth.resize(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
                  static_cast<std::size_t>(size[2]));
    auto* out = smooth.data();
    float least = std::numeric_limits<float>::max(), most = std::numeric_limits<float>::lowest();
    const auto clamped = [&](int i) { return std::clamp(i, first[0], first[0] + size[0]); };
    const int from = clamped(soft.first()), end = clamped(soft.last() + 1);
    each_column(step, [&](std::size_t c) {
        const auto column = soft.column(c);
        auto* const begin = out;
        out = std::fill_n(out, from - first[0], column.front());
        if (end > from) out = std::copy_n(column.data() + (from - soft.first()), end - from, out);
        out = std::fill_n(out, first[0] + size[0] - end, column.back());
        for (const auto* d = begin; d < out; ++d) {
            least = *d < least ? *d : least;
            most = *d > most ? *d : most;
        }
    });
    low = static_cast<int>(std::floor(2 * least));
    high = static_cast<int>(std::ceil(2 * most));
}

void CarveBlock::Table::fill(const CarveStep& step) {
    if (step.soft()) return fill_smooth(step);
    all.resize(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
               static_cast<std::size_t>(size[2]));
    auto out = all.begin();
    low = std::numeric_limits<int>::max();
    high = std::numeric_limits<int>::min();
    const int end = first[0] + size[0];
    each_column(step, [&](std::size_t column) {
        const auto bounds = step.first_displaced(column);
        auto passed = CarveStep::passed(first[0], bounds);
        if (passed == 0 ? end <= bounds.front()
                        : passed == bounds.size() && first[0] > bounds.back()) {
            const int d = step.displacement(first[0], passed, bounds);
            low = std::min(low, d);
            high = std::max(high, d);
            out = std::fill_n(out, size[0], d);
            return;
        }
        for (int i = first[0]; i < end;) {
            while (passed < bounds.size() && bounds[passed] <= i) ++passed;
            const int d = step.displacement(i, passed, bounds);
            low = std::min(low, d);
            high = std::max(high, d);
            // An inserted entry has its own displacement; other entries share theirs up to the
            // next bound.
            const int next = d % 2 != 0               ? i + 1
                             : passed < bounds.size() ? std::min<int>(end, bounds[passed])
                                                      : end;
            out = std::fill_n(out, next - i, d);
            i = next;
        }
    });
}

namespace {

/// The vertices of a step that a box meets.
struct MetVertices {
    std::array<int, 3> first{}, size{};  ///< along the carved, the lateral and the slice axis
    bool any = true;
    bool whole = true;  ///< whether the step holds the whole box
};

/// @param range  in the step's carved space
MetVertices vertices_in(const openvdb::BBoxd& range, const CarveStep& step) {
    const auto& columns = step.columns();
    const auto& axes = columns.axes;
    const std::array<int, 3> first{step.low(), columns.first_lateral, columns.first_slice},
        last{step.high(), columns.around ? 2 * columns.laterals : columns.last_lateral(),
             columns.closed ? 2 * columns.slices : columns.last_slice()};
    MetVertices out;
    for (std::size_t d = 0; d < 3; ++d) {
        const double low = range.min()[axes[d]], high = range.max()[axes[d]],
                     from = low - snap_width, to = high + snap_width, begin = first[d],
                     end = last[d];
        out.any = out.any && to >= begin && from <= end;
        // Planes that a step does not hold lie beyond the lattice, or another step frees them.
        out.whole = out.whole && (axes[d] == 2 || (low >= begin && high <= end));
        out.first[d] = static_cast<int>(std::clamp(from, begin, end));
        out.size[d] = static_cast<int>(std::clamp(to, begin, end)) + 2 - out.first[d];
    }
    // A warp's ends differ from column to column.
    out.whole = out.whole && (!step.warps() || (range.min()[axes[0]] >= step.common().begin &&
                                                range.max()[axes[0]] <= step.common().end));
    return out;
}

bool fades_in(const openvdb::BBoxd& range, const CarveStep& step) {
    if (!step.rims_fade()) return false;
    const int lateral = step.lateral_axis(), slice = step.slice_axis();
    // The scale is concave: its minimum is at a corner.
    for (int corner = 0; corner < 4; ++corner) {
        openvdb::Vec3d at(0.0);
        at[slice] = corner & 1 ? range.min()[slice] : range.max()[slice];
        at[lateral] = corner & 2 ? range.min()[lateral] : range.max()[lateral];
        if (step.rim_scale(at) < 1) return true;
    }
    return false;
}

/// Bounds of displacements, widened to those of the sides that a join shows.
std::pair<double, double> with_sides(double low, double high, const MetVertices& met,
                                     const CarveStep& step) {
    if (!step.joins()) return {low, high};
    const auto sides = step.joins()->range(met.first, met.size);
    return {std::min(low, sides[0]), std::max(high, sides[1])};
}

/// Bounds of the displacements, widened to the entries between which values are blended.
/// @param low, high  bounds of the displacements
/// @param all        whether all points are displaced, by all of it
std::pair<double, double> read_bounds(double low, double high, bool all) {
    // Values are blended from the entries beside a point, and an inserted entry is read at both
    // neighbours.
    low = std::floor(low) - 1;
    high = std::ceil(high) + 1;
    if (all) return {low, high};
    // Points that the step does not hold stay, and fading points are read nearer to where they go.
    return {std::min(0.0, low), std::max(0.0, high)};
}

}  // namespace

bool CarveBlock::move_to(const openvdb::BBoxd& carved) {
    auto range = carved;
    least_ = most_ = openvdb::Vec3d(0);
    frees_ = fades_ = false;
    rigid_ = openvdb::Vec3d(0);
    bool moved = false;
    for (auto n = tables_.size(); n-- > 0;) {
        const auto& step = map_.steps()[n];
        const int axis = step.axis();
        // A box that goes round where entries end and begin may hold any of them.
        if (step.turns() && range.max()[axis] > step.high()) {
            range.min()[axis] = step.low();
            range.max()[axis] = step.high() + 1;
        }
        const auto met = vertices_in(range, step);
        auto& table = tables_[n];
        table.first = met.first;
        table.size = met.size;
        if (!met.any) continue;
        table.fill(step);
        const bool frees = step.may_free(range.min()[axis], range.max()[axis]);
        if (table.low == 0 && table.high == 0 && !frees) continue;
        moved = true;
        frees_ = frees_ || frees;
        const bool fades = fades_in(range, step);
        fades_ = fades_ || fades;
        auto [low, high] = with_sides(0.5 * table.low, 0.5 * table.high, met, step);
        if (low == high && std::floor(low) == low && met.whole && !frees && !fades) {
            if (rigid_) (*rigid_)[axis] += low;
        } else {
            rigid_.reset();
            std::tie(low, high) = read_bounds(low, high, met.whole && !fades);
        }
        range.min()[axis] += low;
        range.max()[axis] += high;
        least_[axis] += low;
        most_[axis] += high;
    }
    return moved;
}

}  // namespace fluidcarve
