#pragma once

#include "carve/remap/voxels/blend.h"
#include "carve/remap/voxels/carve_block.h"
#include "carve/seam/carve_map.h"

#include <openvdb/Types.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace fluidcarve {

/// Blends the sources of a point in cells whose corners move differently (METHOD 4): follows the
/// steps of a map from the last to the first.
/// @tparam Read  returns the ValueAndState at lattice coordinates before the carve
template <class Part, class Read>
class SourceBlend {
public:
    /// All must outlive it; the block must hold the point.
    SourceBlend(const CarveMap& map, const CarveBlock& block, const Part& background,
                const Read& read)
        : map_(map), block_(block), background_(background), read_(read) {}

    /// Adds the content at lattice coordinates `l` after the first `count` steps, with a weight.
    void add(std::size_t count, openvdb::Vec3d l, double weight) {
        for (; count > 0; --count) {
            const auto& step = map_.steps()[count - 1];
            if (!step.holds(l)) continue;
            const double scale = step.rim_scale(l);
            if (scale < 1) fades_ = true;
            if (!step.carves(l, scale)) {
                if (!step.frees(l)) continue;
                return blend_.add({background_, false}, weight);
            }
            double& u = l[step.axis()];
            if (step.soft()) {
                u = step.clamped(u + scale * block_.smooth(count - 1, l));
                continue;
            }
            const auto cell = block_.cell(count - 1, l);
            const int all = cell.columns[0].low;
            if (!cell.rigid || all % 2 != 0) return add_cell(cell, count, l, scale, weight);
            u = step.faded_source(u, u + 0.5 * all, scale);
        }
        blend_.add(read(l), weight);
    }
    ValueAndState<Part> result() const { return blend_.result(background_); }
    /// Whether a fade of rims scaled a displacement.
    bool fades() const { return fades_; }

private:
    /// Adds the entries of a cell of step `count - 1`.
    void add_cell(const CarveBlock::Cell& cell, std::size_t count, const openvdb::Vec3d& l,
                  double scale, double weight) {
        const auto& step = map_.steps()[count - 1];
        const double u = l[step.axis()];
        const auto add_even = [&](double entry, int displacement, double share) {
            auto source = l;
            source[step.axis()] = step.faded_source(u, entry + 0.5 * displacement, scale);
            add(count - 1, source, share);
        };
        const auto add_entry = [&](double entry, int displacement, double share) {
            if (displacement % 2 == 0) return add_even(entry, displacement, share);
            // An inserted entry is the mean of its neighbours, whatever the interpolation.
            add_even(entry, displacement - 1, share / 2);
            add_even(entry, displacement + 1, share / 2);
        };
        if (cell.rigid) return add_entry(u, cell.columns[0].low, weight);
        for (std::size_t n = 0; n < cell.count; ++n) {
            const auto& column = cell.columns[n];
            const double share = weight * column.weight;
            if (column.low == column.high) {
                add_entry(u, column.low, share);
            } else {
                add_entry(std::floor(u), column.low, share * (1 - cell.fraction));
                add_entry(std::floor(u) + 1, column.high, share * cell.fraction);
            }
        }
    }

    /// Columns that move equally ask for the same source, so the last few results are kept.
    ValueAndState<Part> read(const openvdb::Vec3d& source) {
        for (std::size_t n = 0; n < std::min(count_, kept_.size()); ++n)
            if (kept_[n].source == source) return kept_[n].sample;
        auto& next = kept_[count_++ % kept_.size()];
        next = {source, read_(source)};
        return next.sample;
    }

    struct Kept {
        openvdb::Vec3d source;
        ValueAndState<Part> sample;
    };

    const CarveMap& map_;
    const CarveBlock& block_;
    const Part& background_;
    const Read& read_;
    Blend<Part> blend_;
    bool fades_ = false;
    std::array<Kept, 4> kept_;
    std::size_t count_ = 0;  ///< sources read
};

}  // namespace fluidcarve
