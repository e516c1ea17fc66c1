#include "carve/remap/voxels/aligned.h"

#include "carve/field/extent.h"
#include "carve/remap/voxels/blend.h"
#include "carve/remap/voxels/blocks.h"
#include "carve/remap/voxels/soft_block.h"
#include "carve/volume/grid_types.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

namespace fluidcarve {

namespace {

using openvdb::BBoxd;
using openvdb::Coord;
using openvdb::CoordBBox;

CoordBBox voxels(const Alignment& alignment, const BBoxd& range) {
    const auto at = [&](const openvdb::Vec3d& p, auto&& round) {
        return alignment.voxel(round(p.x()), round(p.y()), round(p.z()));
    };
    const auto a = at(range.min(), [](double x) { return static_cast<int>(std::floor(x)); }),
               b = at(range.max(), [](double x) { return static_cast<int>(std::ceil(x)); });
    return {Coord::minComponent(a, b), Coord::maxComponent(a, b)};
}

/// Carves an aligned grid block by block.
template <class GridT>
class AlignedCarve {
    using TreeT = typename GridT::TreeType;
    using Leaf = typename TreeT::LeafNodeType;
    using Value = typename TreeT::ValueType;
    using Voxel = typename BlockWindow<TreeT>::Voxel;

public:
    AlignedCarve(const GridT& grid, const Alignment& alignment, const CarveMap& map)
        : alignment_(alignment),
          map_(map),
          steps_(map.steps()),
          lines_(alignment, steps_.back()),
          window_(grid.tree()),
          nothing_{grid.background(), false} {
        if (steps_.back().soft()) soft_.emplace(grid, lines_);
    }

    bool operator()(const Coord& block, Leaf& out) {
        const auto a = alignment_.vertex(block), b = alignment_.vertex(block.offsetBy(7));
        BBoxd range(Coord::minComponent(a, b).asVec3d(), Coord::maxComponent(a, b).asVec3d());
        if (soft_ && soft_->staggered()) range.expand(0.5);
        bool frees = false;
        if (!map_.trace(range, frees)) return false;
        // Values between two faces come from both.
        if (soft_ && soft_->staggered()) range.expand(0.5);
        const auto read = voxels(alignment_, range);
        window_.move_to(read);
        if (window_.uniform() &&
            (!frees || (!window_.tile().on && same_bits(window_.tile().value, nothing_.value))))
            return false;

        if (soft_) return soft_->carve(window_, read, out);
        // Lines in slices outside of all steps do not move. In a block of an image, these are all
        // lines but a few. Slices that a line crosses count as met.
        const auto held = [&](const Coord& vertex) {
            return std::ranges::any_of(steps_, [&](const CarveStep& step) {
                const int slice = vertex[step.slice_axis()];
                return step.slice_axis() == steps_.back().axis() ||
                       (slice >= step.columns().first_slice &&
                        slice <= step.columns().last_slice());
            });
        };
        const bool within = held(a) && held(b);
        if (!within) window_.read(out);
        Coord line;
        const auto [p, q] = lines_.across;
        line[lines_.index_axis] = block[lines_.index_axis] + (lines_.direction > 0 ? 0 : 7);
        for (line[p] = block[p]; line[p] < block[p] + 8; ++line[p])
            for (line[q] = block[q]; line[q] < block[q] + 8; ++line[q]) {
                if (!within && !held(alignment_.vertex(line))) continue;
                carve_row(line, out);
            }
        return true;
    }

private:
    /// Carves eight voxels in the direction of rising entries, under the last step. So the bounds
    /// of their column are traversed only once.
    void carve_row(Coord voxel, Leaf& out) {
        const auto& step = steps_.back();
        const auto rest = steps_.size() - 1;
        const int axis = step.axis();
        const auto first = alignment_.vertex(voxel);
        const bool carved = step.columns().has(first);
        const auto bounds = carved ? step.first_displaced(first) : std::span<const std::uint16_t>();
        auto passed = CarveStep::passed(first[axis], bounds);

        const int end = first[axis] + 8;
        for (int entry = first[axis], count = 1; entry < end;
             entry += count, voxel[lines_.index_axis] += lines_.direction * count) {
            while (passed < bounds.size() && bounds[passed] <= entry) ++passed;
            const auto moved = [&](int source) {
                auto place = voxel;
                place[lines_.index_axis] += lines_.direction * (source - entry);
                return place;
            };
            const auto at = [&](int source) {
                return rest == 0 ? window_.get(moved(source))
                                 : resolve(rest, alignment_.vertex(moved(source)));
            };
            count = 1;
            const bool in_step = carved && entry >= step.low() && entry <= step.high();
            if (in_step && (entry < step.start() || entry > step.last())) {
                write(out, voxel, nothing_);
                continue;
            }
            const int d = in_step ? step.displacement(entry, passed, bounds) : 0;
            if (rest > 0 || d % 2 != 0) {
                write(out, voxel, displaced(entry, d, at));
                continue;
            }
            // The entries up to the next bound have the same displacement.
            int same = end;
            if (in_step)
                same = std::min({end, step.last() + 1,
                                 passed < bounds.size() ? static_cast<int>(bounds[passed]) : end});
            else if (carved && entry < step.low()) same = std::min(end, step.low());
            count = same - entry;
            window_.copy_line(moved(entry + d / 2), lines_.index_axis, lines_.direction, count, out,
                              Leaf::coordToOffset(voxel));
        }
    }

    /// The voxel at a vertex after the first `count` steps.
    Voxel resolve(std::size_t count, Coord vertex) const {
        for (; count > 0; --count) {
            const auto& step = steps_[count - 1];
            const int axis = step.axis(), entry = vertex[axis];
            if (!step.columns().has(vertex) || entry < step.low() || entry > step.high()) continue;
            if (entry < step.start() || entry > step.last()) return nothing_;
            const int d =
                step.displacement(entry, vertex[step.lateral_axis()], vertex[step.slice_axis()]);
            if (d % 2 != 0)
                return displaced(entry, d, [&](int source) {
                    vertex[axis] = source;
                    return resolve(count - 1, vertex);
                });
            vertex[axis] += d / 2;
        }
        return window_.get(alignment_.voxel(vertex.x(), vertex.y(), vertex.z()));
    }

    template <class At>
    static Voxel displaced(int entry, int d, At&& at) {
        if (d % 2 == 0) return at(entry + d / 2);
        const Voxel low = at(entry + (d - 1) / 2);
        const Voxel high = at(entry + (d + 1) / 2);
        // In a mask the state is the value.
        if constexpr (std::is_same_v<typename TreeT::BuildType, openvdb::ValueMask>) return low;
        else return {inserted_value(low.value, high.value), low.on || high.on};
    }

    static void write(Leaf& out, const Coord& at, const Voxel& voxel) {
        const auto offset = Leaf::coordToOffset(at);
        out.setValueOnly(offset, voxel.value);
        out.setActiveState(offset, voxel.on);
    }

    const Alignment& alignment_;
    const CarveMap& map_;
    const std::vector<CarveStep>& steps_;
    const StepLines lines_;  ///< of the last step
    BlockWindow<TreeT> window_;
    const Voxel nothing_;
    /// If the last step is smoothed; then it is the only one.
    std::optional<SoftBlock<GridT>> soft_;
};

}  // namespace

template <class GridT>
typename GridT::ConstPtr carve_aligned(const typename GridT::ConstPtr& grid,
                                       const Alignment& alignment, const CarveMap& map) {
    if (map.empty()) return grid;
    // A component's face may lie in the lattice where its voxel's centre does not.
    return rewrite_blocks<GridT>(grid, padded(voxels(alignment, map.moved()), 1), [&] {
        return block_worker<GridT, AlignedCarve<GridT>>(*grid, alignment, map);
    });
}

#define FLUIDCARVE_INSTANTIATE(GridT)                                                       \
    template GridT::ConstPtr carve_aligned<GridT>(const GridT::ConstPtr&, const Alignment&, \
                                                  const CarveMap&);
FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_INSTANTIATE)
#undef FLUIDCARVE_INSTANTIATE

}  // namespace fluidcarve
