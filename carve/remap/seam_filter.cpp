#include "carve/remap/seam_filter.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "carve/remap/voxels/blend.h"
#include "carve/remap/voxels/blocks.h"
#include "carve/remap/voxels/places.h"
#include "carve/remap/voxels/seam_cells.h"
#include "carve/seam/carve_map.h"
#include "carve/volume/triplet.h"
#include "carve/volume/volume.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace fluidcarve {

namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

/// Filter weights along one axis, from the farthest voxel below to the farthest above: one mean, or
/// four means in a row.
std::vector<double> weights(FilterMode mode, int width) {
    const auto size = 2 * static_cast<std::size_t>(width) + 1;
    const std::vector<double> mean(size, 1.0 / static_cast<double>(size));
    auto out = mean;
    for (int n = mode == FilterMode::gaussian ? 3 : 0; n > 0; --n) {
        std::vector<double> wider(out.size() + size - 1, 0.0);
        for (std::size_t a = 0; a < out.size(); ++a)
            for (std::size_t b = 0; b < size; ++b) wider[a + b] += out[a] * mean[b];
        out = std::move(wider);
    }
    return out;
}

/// Filters the 8^3 voxels of a block from the cube around them, one axis after the other.
/// @param values  `[x][y][z]`, 8 + weights.size() - 1 along each axis; becomes the filtered values,
///   8 along each axis
void filter_axes(std::vector<double>& values, std::vector<double>& scratch,
                 const std::vector<double>& weights) {
    const auto wide = 7 + weights.size();
    std::size_t rows = wide * wide;
    // Each pass filters along the last axis and brings it to the front. After three passes, the
    // axes are in their old order.
    for (int pass = 0; pass < 3; ++pass, rows = rows / wide * 8) {
        scratch.assign(8 * rows, 0.0);
        for (std::size_t row = 0; row < rows; ++row)
            for (std::size_t at = 0; at < 8; ++at) {
                double sum = 0;
                for (std::size_t n = 0; n < weights.size(); ++n)
                    sum += weights[n] * values[row * wide + at + n];
                scratch[at * rows + row] = sum;
            }
        values.swap(scratch);
    }
}

/// The lowest voxel at which something was found; used by many threads.
class Lowest {
public:
    void add(const Coord& at) {
        const std::lock_guard lock(mutex_);
        if (!lowest_ || at < *lowest_) lowest_ = at;
    }
    const std::optional<Coord>& get() const { return lowest_; }

private:
    std::mutex mutex_;
    std::optional<Coord> lowest_;
};

struct Filter {
    FilterMode mode;
    int width;
    std::vector<double> weights;
    int reach() const {
        return mode == FilterMode::median ? width : static_cast<int>(weights.size() / 2);
    }
};

/// Filters the voxels along seams, block by block.
template <class GridT>
class FilteredBlocks {
    using TreeT = typename GridT::TreeType;
    using Leaf = typename TreeT::LeafNodeType;
    using Value = typename TreeT::ValueType;
    using Traits = openvdb::VecTraits<Value>;
    using Element = typename Traits::ElementType;
    using Marks = std::bitset<Leaf::SIZE>;

public:
    FilteredBlocks(const GridT& grid, CarvedPlaces places, const CarveMap& map,
                   const Filter& filter, Lowest& not_finite)
        : map_(map),
          filter_(filter),
          not_finite_(not_finite),
          staggered_(Traits::IsVec && grid.getGridClass() == openvdb::GRID_STAGGERED &&
                     !places.aligned()),
          places_(std::move(places)),
          window_(grid.tree()) {}

    bool operator()(const Coord& block, Leaf& out) {
        if (!may_hold_seam(map_, places_.move_to(block))) return false;
        window_.move_to(CoordBBox::createCube(block, 8));
        if (window_.uniform() && !window_.tile().on) return false;
        window_.read(out);
        std::array<Marks, Traits::Size> marks;
        if (staggered_)
            for (int c = 0; c < Traits::Size; ++c)
                marks[static_cast<std::size_t>(c)] = seam_voxels(out, c);
        else marks.fill(seam_voxels(out, -1));
        if (std::ranges::all_of(marks, [](const Marks& each) { return each.none(); })) return false;

        window_.move_to({block.offsetBy(-filter_.reach()), block.offsetBy(7 + filter_.reach())});
        if (window_.uniform()) return false;
        for (int c = 0; c < Traits::Size; ++c) {
            const auto& mine = marks[static_cast<std::size_t>(c)];
            if (mine.none()) continue;
            if (filter_.mode == FilterMode::median) take_medians(out, mine, c);
            else take_means(out, mine, c);
        }
        return true;
    }

private:
    /// The active voxels that lie along a seam.
    /// @param face  component at whose faces to look; -1: at the voxels' centres
    Marks seam_voxels(const Leaf& leaf, int face) {
        Vec3d offset(0);
        if (face >= 0) offset[face] = -0.5;
        Marks out;
        for (openvdb::Index n = 0; n < Leaf::SIZE; n += 8) {
            places_.locate(leaf.offsetToGlobalCoord(n), offset, row_);
            for (openvdb::Index z = 0; z < 8; ++z)
                out[n + z] = leaf.isValueOn(n + z) && (row_.inside >> z & 1) != 0 &&
                             along_seam(map_, row_.at[z]);
        }
        return out;
    }

    Element component(const Coord& at, int c) const {
        const Value value = window_.get(at).value;
        if constexpr (Traits::IsVec) return value[c];
        else return static_cast<void>(c), value;
    }

    void set(Leaf& out, openvdb::Index n, int c, Element value) {
        if (!std::isfinite(value)) return not_finite_.add(out.offsetToGlobalCoord(n));
        Value whole = out.getValue(n);
        if constexpr (Traits::IsVec) whole[c] = value;
        else whole = value;
        out.setValueOnly(n, whole);
    }

    void take_means(Leaf& out, const Marks& marks, int c) {
        const int reach = filter_.reach();
        values_.clear();
        const CoordBBox cube(out.origin().offsetBy(-reach), out.origin().offsetBy(7 + reach));
        for (auto at = cube.begin(); at; ++at)
            values_.push_back(static_cast<double>(component(*at, c)));
        filter_axes(values_, scratch_, filter_.weights);
        for (openvdb::Index n = 0; n < Leaf::SIZE; ++n)
            if (marks[n]) set(out, n, c, static_cast<Element>(values_[n]));
    }

    void take_medians(Leaf& out, const Marks& marks, int c) {
        for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
            if (!marks[n]) continue;
            const auto at = out.offsetToGlobalCoord(n);
            const CoordBBox cube(at.offsetBy(-filter_.width), at.offsetBy(filter_.width));
            values_.clear();
            for (auto near = cube.begin(); near; ++near)
                values_.push_back(static_cast<double>(component(*near, c)));
            // Values that are not finite can't be ordered.
            if (!std::ranges::all_of(values_, [](double value) { return std::isfinite(value); })) {
                not_finite_.add(at);
                continue;
            }
            const auto middle = values_.begin() + static_cast<std::ptrdiff_t>(values_.size() / 2);
            std::nth_element(values_.begin(), middle, values_.end());
            set(out, n, c, static_cast<Element>(*middle));
        }
    }

    const CarveMap& map_;
    const Filter& filter_;
    Lowest& not_finite_;
    const bool staggered_;
    CarvedPlaces places_;
    CarvedPlaces::Row row_;
    BlockWindow<TreeT> window_;
    std::vector<double> values_, scratch_;
};

template <class GridT>
openvdb::GridBase::ConstPtr filtered(const openvdb::GridBase::ConstPtr& base,
                                     const CarvedPlaces& places, const CarveMap& map,
                                     const Filter& filter) {
    const auto grid = openvdb::GridBase::grid<GridT>(base);
    Lowest not_finite;
    const auto out = rewrite_blocks<GridT>(grid, places.voxels(map.moved()), [&] {
        return block_worker<GridT, FilteredBlocks<GridT>>(*grid, places, map, filter, not_finite);
    });
    if (const auto& at = not_finite.get())
        throw Failure(
            fmt::format("grid '{}' has a value that is not finite (NaN or infinite) within {} "
                        "voxels of [{}], which lies along a seam; repair it where it "
                        "comes from",
                        base->getName(), filter.reach(), numbers_text(*at)));
    return out;
}

}  // namespace

Volume seam_filtered(const Volume& volume, const Lattice& given, const CarveMap& map,
                     FilterMode mode, int width) {
    if (map.empty()) return volume;
    const auto lattice = map.extended(given);
    const Filter filter{mode, width, weights(mode, width)};
    Volume out = volume;
    for (auto& each : out.grids) {
        const auto grid = each.grid();
        const auto triplet = triplet_of(volume, *grid);
        const auto place = [&] {
            return CarvedPlaces(lattice, map.reach(), grid->transform(),
                                triplet ? *triplet->cells : grid->transform());
        };
        if (grid->isType<openvdb::FloatGrid>())
            each = each.holding(filtered<openvdb::FloatGrid>(grid, place(), map, filter));
        else if (grid->isType<openvdb::DoubleGrid>())
            each = filtered<openvdb::DoubleGrid>(grid, place(), map, filter);
        else if (grid->isType<openvdb::Vec3SGrid>())
            each = filtered<openvdb::Vec3SGrid>(grid, place(), map, filter);
        else if (grid->isType<openvdb::Vec3DGrid>())
            each = filtered<openvdb::Vec3DGrid>(grid, place(), map, filter);
    }
    return out;
}

}  // namespace fluidcarve
