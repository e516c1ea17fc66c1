#include "carve/remap/voxels/carve_block.h"

#include "carve/lattice/snap.h"
#include "carve/seam/joins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace fluidcarve {

template <class Column>
void CarveBlock::Table::each_column(const CarveStep& step, const Column& column) const {
    for (int k = first[2]; k < first[2] + size[2]; ++k)
        for (int j = first[1]; j < first[1] + size[1]; ++j)
            column(step.around() ? j % step.laterals() : std::min(j, step.last_lateral()),
                   step.closed() ? k % step.slices() : std::min(k, step.last_slice()));
}

void CarveBlock::Table::fill_smooth(const CarveStep& step) {
    const auto& soft = *step.soft();
    smooth.resize(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
                  static_cast<std::size_t>(size[2]));
    auto* out = smooth.data();
    float least = std::numeric_limits<float>::max(), most = std::numeric_limits<float>::lowest();
    const auto held = [&](int i) { return std::clamp(i, first[0], first[0] + size[0]); };
    const int from = held(soft.first()), end = held(soft.last() + 1);
    each_column(step, [&](int lateral, int k) {
        const auto column = soft.column(lateral, k);
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
    each_column(step, [&](int lateral, int k) {
        const auto bounds = step.bounds(lateral, k);
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

bool CarveBlock::move_to(const openvdb::BBoxd& carved) {
    auto range = carved;
    least_ = most_ = openvdb::Vec3d(0);
    frees_ = false;
    fades_ = false;
    rigid_ = openvdb::Vec3d(0);
    bool moved = false;
    for (auto n = tables_.size(); n-- > 0;) {
        const auto& step = map_.steps()[n];
        auto& table = tables_[n];
        const std::array<int, 3> axes{step.axis(), step.lateral_axis(), step.slice_axis()};
        const std::array<int, 3> first{step.low(), step.first_lateral(), step.first_slice()},
            last{step.high(), step.around() ? 2 * step.laterals() : step.last_lateral(),
                 step.closed() ? 2 * step.slices() : step.last_slice()};
        // A box across the closing of the ring may hold any entry.
        if (step.turns() && range.max()[axes[0]] > step.high()) {
            range.min()[axes[0]] = step.low();
            range.max()[axes[0]] = step.high() + 1;
        }
        bool meets = true, within = true;
        for (std::size_t d = 0; d < 3; ++d) {
            const double from = range.min()[axes[d]] - snap_width,
                         to = range.max()[axes[d]] + snap_width, begin = first[d], end = last[d];
            meets = meets && to >= begin && from <= end;
            // Planes that a step does not hold lie beyond the lattice, or another step frees them.
            within = within && (axes[d] == 2 ||
                                (range.min()[axes[d]] >= begin && range.max()[axes[d]] <= end));
            table.first[d] = static_cast<int>(std::clamp(from, begin, end));
            table.size[d] = static_cast<int>(std::clamp(to, begin, end)) + 2 - table.first[d];
        }
        if (!meets) continue;
        table.fill(step);
        const int axis = step.axis();
        const bool frees = step.may_free(range.min()[axis], range.max()[axis]);
        // A warp's ends differ from column to column.
        within = within && (!step.warps() || (range.min()[axis] >= step.common().begin &&
                                              range.max()[axis] <= step.common().end));
        if (table.low == 0 && table.high == 0 && !frees) continue;
        moved = true;
        frees_ = frees_ || frees;
        // The scale is concave: its minimum is at a corner.
        bool fades = false;
        for (int corner = 0; step.fades() && corner < 4; ++corner) {
            openvdb::Vec3d at(0.0);
            at[axes[2]] = corner & 1 ? range.min()[axes[2]] : range.max()[axes[2]];
            at[axes[1]] = corner & 2 ? range.min()[axes[1]] : range.max()[axes[1]];
            fades = fades || step.scale(at) < 1;
        }
        fades_ = fades_ || fades;
        double low = 0.5 * table.low, high = 0.5 * table.high;
        if (const auto* const joins = step.joins()) {
            const auto sides = joins->range(table.first, table.size);
            low = std::min(low, sides[0]);
            high = std::max(high, sides[1]);
        }
        if (low == high && std::floor(low) == low && within && !frees && !fades) {
            if (rigid_) (*rigid_)[axis] += low;
        } else {
            rigid_.reset();
            // Values are blended from the entries beside a point, and an inserted entry is read at
            // both neighbours.
            low = std::floor(low) - 1;
            high = std::ceil(high) + 1;
            // Points outside the step stay, and fading points are read nearer to their
            // destination.
            if (!within || fades) {
                low = std::min(0.0, low);
                high = std::max(0.0, high);
            }
        }
        range.min()[axis] += low;
        range.max()[axis] += high;
        least_[axis] += low;
        most_[axis] += high;
    }
    return moved;
}

}  // namespace fluidcarve
