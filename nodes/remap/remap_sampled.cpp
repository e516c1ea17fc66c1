#include "nodes/remap/remap_sampled.h"

#include "nodes/remap/blocks.h"
#include "nodes/remap/cubic.h"
#include "nodes/remap/grid_types.h"
#include "nodes/remap/value_blend.h"

#include <openvdb/tools/Interpolation.h>

#include <cmath>
#include <memory>

namespace fluidcarve {

namespace {

using openvdb::BBoxd;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

/// Voxels beside a position that any interpolation reads, with room for a component's half step.
constexpr double support = 3;

CoordBBox index_box(const openvdb::math::Transform& transform, const Mapping& mapping, const BBoxd& range, double margin) {
    const auto box = transform.worldToIndex(mapping.world_box(range));
    return {Coord::floor(box.min() - Vec3d(margin)), Coord::ceil(box.max() + Vec3d(margin))};
}

/// The cell of a step's carved space that holds a point: which columns weigh in, and how their entries are displaced.
struct Cell {
    struct Column {
        double weight;
        int low, high;  ///< displacements of the entries below and above, half vertices
    };
    std::array<Column, 4> columns;
    std::size_t count = 0;
    double fraction;    ///< between the entries
    bool rigid = true;  ///< all displacements are the same

    Cell(const CarveStep& step, const Vec3d& at) {
        const double u = at[step.axis()], v = at[step.lateral_axis()], w = at.z();
        const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v)), k = static_cast<int>(std::floor(w));
        fraction = u - i;
        for (int n = 0; n < 4; ++n) {
            const int dj = n & 1, dk = n >> 1;
            const double weight = (dj ? v - j : 1 - (v - j)) * (dk ? w - k : 1 - (w - k));
            if (weight == 0) continue;
            const auto bounds = step.bounds(j + dj, k + dk);
            auto passed = CarveStep::passed(i, bounds);
            const int low = step.displacement(i, passed, bounds);
            int high = low;
            if (fraction > 0) {
                while (passed < bounds.size() && bounds[passed] <= i + 1) ++passed;
                high = step.displacement(i + 1, passed, bounds);
            }
            columns[count++] = {weight, low, high};
            rigid = rigid && low == columns[0].low && high == columns[0].low;
        }
    }
};

template <class GridT>
class Worker {
    using TreeT = typename GridT::TreeType;
    using Leaf = typename TreeT::LeafNodeType;
    using Value = typename TreeT::ValueType;
    static constexpr bool is_vector = openvdb::VecTraits<Value>::IsVec;

public:
    Worker(const GridT& grid, const Mapping& mapping, const CarveMap& map, Interpolation interpolation)
        : grid_(grid),
          mapping_(mapping),
          map_(map),
          interpolation_(interpolation),
          staggered_(is_vector && can_blend<Value> && grid.getGridClass() == openvdb::GRID_STAGGERED),
          window_(grid.tree()),
          values_(grid.getConstAccessor()) {}

    bool operator()(const Coord& block, Leaf& out) {
        const auto& transform = grid_.transform();
        const auto low = block.asVec3d();
        BBoxd range = mapping_.range(transform.indexToWorld(BBoxd(low - Vec3d(0.5), low + Vec3d(7))));
        bool frees = false;
        if (!map_.trace(range, frees)) return false;
        auto sources = index_box(transform, mapping_, range, support);
        sources.expand(CoordBBox::createCube(block, 8));
        window_.move_to(sources);
        if (window_.uniform() && (!frees || (!window_.tile().on && same_bits(window_.tile().value, grid_.background())))) return false;

        for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
            const auto at = out.offsetToGlobalCoord(n);
            const auto own = window_.get(at);
            auto [value, on] = own;
            if constexpr (is_vector && can_blend<Value>) {
                if (staggered_) carve_faces(at, value, on);
                else carve_centre(at, value, on);
            } else {
                carve_centre(at, value, on);
            }
            out.setValueOnly(n, value);
            out.setActiveState(n, on);
        }
        return true;
    }

private:
    void carve_centre(const Coord& at, Value& value, bool& on) {
        const auto p = at.asVec3d();
        const auto l = mapping_.locate(grid_.indexToWorld(p));
        if (!l) return;
        Blend<Value> blend;
        gather<Value>(map_.steps().size(), *l, 1.0, grid_.background(), blend, reader<Value>(p, *l, value, on, [](const Value& got) { return got; }));
        value = blend.value();
        on = blend.on();
    }

    /// Component c of a staggered grid stands half a voxel below its voxel's centre along axis c.
    void carve_faces(const Coord& at, Value& value, bool& on) {
        using Element = typename openvdb::VecTraits<Value>::ElementType;
        const auto own = value;
        const bool own_on = on;
        on = false;
        for (int c = 0; c < 3; ++c) {
            auto face = at.asVec3d();
            face[c] -= 0.5;
            const auto l = mapping_.locate(grid_.indexToWorld(face));
            if (!l) {
                on = on || own_on;
                continue;
            }
            Blend<Element> blend;
            gather<Element>(map_.steps().size(), *l, 1.0, grid_.background()[c], blend,
                            reader<Element>(at.asVec3d(), *l, own[c], own_on, [c](const Value& got) { return got[c]; }));
            value[c] = blend.value();
            on = on || blend.on();
        }
    }

    /// Reads the field displaced by `G(l') - G(l)` from voxel position `p`; undisplaced, the voxel's own value.
    template <class Part, class Pick>
    auto reader(const Vec3d& p, const Vec3d& l, const Part& own, bool own_on, Pick pick) {
        const auto& transform = grid_.transform();
        return [=, this, &transform](const Vec3d& source) -> std::pair<Part, bool> {
            if (source == l) return {own, own_on};
            const auto q = snapped(p + transform.worldToIndex(mapping_.position(source)) - transform.worldToIndex(mapping_.position(l)));
            return {pick(sample(q)), values_.isValueOn(Coord::round(q))};
        };
    }

    Value sample(const Vec3d& q) {
        const auto nearest = Coord::round(q);
        if constexpr (can_blend<Value>) {
            if (q != nearest.asVec3d()) {
                switch (interpolation_) {
                    case Interpolation::linear: return openvdb::tools::BoxSampler::sample(values_, q);
                    case Interpolation::quadratic: return openvdb::tools::QuadraticSampler::sample(values_, q);
                    case Interpolation::cubic: return sample_cubic<Value>(values_, q);
                }
            }
        }
        return values_.getValue(nearest);
    }

    /// Adds, with a weight, what stands at lattice coordinates `l` after the first `count` steps.
    template <class Part, class Read>
    void gather(std::size_t count, Vec3d l, double weight, const Part& nothing, Blend<Part>& out, const Read& read) {
        for (; count > 0; --count) {
            const auto& step = map_.steps()[count - 1];
            const int axis = step.axis();
            const double u = l[axis], v = l[step.lateral_axis()];
            if (u < 0 || u > step.reach() - 1 || v < 0 || v > step.laterals() - 1 || l.z() < 0 || l.z() > step.slices() - 1) continue;
            if (u > step.after() - 1) return out.add(nothing, false, weight);

            const auto from = [&](double entry, int displacement, double share) {
                const auto at = [&](int half, double part) {
                    auto source = l;
                    const int whole = half / 2;
                    source[axis] = entry + whole;
                    gather(count - 1, source, part, nothing, out, read);
                };
                if (displacement % 2 == 0) return at(displacement, share);
                // An inserted entry is the mean of its neighbours, whatever the interpolation.
                at(displacement - 1, share / 2);
                at(displacement + 1, share / 2);
            };
            const Cell cell(step, l);
            if (cell.rigid) {
                if (cell.columns[0].low % 2 != 0) return from(u, cell.columns[0].low, weight);
                const int whole = cell.columns[0].low / 2;
                l[axis] = u + whole;
                continue;
            }
            for (std::size_t n = 0; n < cell.count; ++n) {
                const auto& column = cell.columns[n];
                if (column.low == column.high) {
                    from(u, column.low, weight * column.weight);
                } else {
                    from(std::floor(u), column.low, weight * column.weight * (1 - cell.fraction));
                    from(std::floor(u) + 1, column.high, weight * column.weight * cell.fraction);
                }
            }
            return;
        }
        const auto [value, on] = read(l);
        out.add(value, on, weight);
    }

    const GridT& grid_;
    const Mapping& mapping_;
    const CarveMap& map_;
    const Interpolation interpolation_;
    const bool staggered_;
    BlockWindow<TreeT> window_;
    typename GridT::ConstAccessor values_;
};

}  // namespace

template <class GridT>
typename GridT::ConstPtr carve_sampled(const typename GridT::ConstPtr& grid, const Mapping& mapping, const CarveMap& map, Interpolation interpolation) {
    if (map.empty()) return grid;
    // A component's face reaches the lattice before its voxel's centre does.
    const auto box = index_box(grid->transform(), mapping, map.moved(), 1);
    return rewrite_blocks<GridT>(grid, box, [&] {
        return [worker = std::make_shared<Worker<GridT>>(*grid, mapping, map, interpolation)](const Coord& block, LeafOf<GridT>& out) {
            return (*worker)(block, out);
        };
    });
}

#define FLUIDCARVE_INSTANTIATE(GridT) template GridT::ConstPtr carve_sampled<GridT>(const GridT::ConstPtr&, const Mapping&, const CarveMap&, Interpolation);
FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_INSTANTIATE)
#undef FLUIDCARVE_INSTANTIATE

}  // namespace fluidcarve
