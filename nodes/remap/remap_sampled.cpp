#include "nodes/remap/remap_sampled.h"

#include "nodes/lattice/block_places.h"
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
        const int i = static_cast<int>(u), j = static_cast<int>(v), k = static_cast<int>(w);
        fraction = u - i;
        // Mostly all columns are passed by all seams, or by none.
        const int last = fraction > 0 ? i + 1 : i;
        std::array<std::span<const std::uint16_t>, 4> bounds;
        bool below = true, above = true;
        const double to_j = v - j, to_k = w - k;
        for (int n = 0; n < 4; ++n) {
            const double weight = (n & 1 ? to_j : 1 - to_j) * (n & 2 ? to_k : 1 - to_k);
            if (weight == 0) continue;
            columns[count].weight = weight;
            bounds[count] = step.bounds(j + (n & 1), k + (n >> 1));
            below = below && last < bounds[count].front();
            above = above && i > bounds[count].back();
            ++count;
        }
        if (below || above) {
            columns[0].low = columns[0].high = step.displacement(i, below ? 0 : bounds[0].size(), bounds[0]);
            return;
        }
        for (std::size_t n = 0; n < count; ++n) {
            auto& column = columns[n];
            auto passed = CarveStep::passed(i, bounds[n]);
            column.low = column.high = step.displacement(i, passed, bounds[n]);
            if (fraction > 0) {
                while (passed < bounds[n].size() && bounds[n][passed] <= i + 1) ++passed;
                column.high = step.displacement(i + 1, passed, bounds[n]);
            }
            rigid = rigid && column.low == columns[0].low && column.high == columns[0].low;
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
    Worker(const GridT& grid, const Mapping& mapping, const BlockPlaces& places, const CarveMap& map, Interpolation interpolation)
        : grid_(grid),
          mapping_(mapping),
          places_(places),
          map_(map),
          interpolation_(interpolation),
          staggered_(is_vector && can_blend<Value> && grid.getGridClass() == openvdb::GRID_STAGGERED),
          window_(grid.tree()),
          values_(grid.getConstAccessor()) {}

    bool operator()(const Coord& block, Leaf& out) {
        auto range = places_.move_to(block);
        bool frees = false;
        if (!map_.trace(range, frees)) return false;
        auto sources = index_box(grid_.transform(), mapping_, range, support);
        sources.expand(CoordBBox::createCube(block, 8));
        window_.move_to(sources);
        if (window_.uniform() && (!frees || (!window_.tile().on && same_bits(window_.tile().value, grid_.background())))) return false;

        for (openvdb::Index n = 0; n < Leaf::SIZE; n += 8) {
            const auto first = out.offsetToGlobalCoord(n);
            std::array<Voxel, 8> row;
            window_.read(first, row);
            if constexpr (is_vector && can_blend<Value>) {
                if (staggered_) carve_faces(first, row);
                else carve_centres(first, row);
            } else {
                carve_centres(first, row);
            }
            for (openvdb::Index z = 0; z < 8; ++z) {
                out.setValueOnly(n + z, row[z].value);
                out.setActiveState(n + z, row[z].on);
            }
        }
        return true;
    }

private:
    using Voxel = typename BlockWindow<TreeT>::Voxel;

    void carve_centres(const Coord& first, std::array<Voxel, 8>& row) {
        places_.locate(first, Vec3d(0), found_);
        for (int z = 0; z < 8; ++z) {
            if ((found_.inside >> z & 1) == 0) continue;
            auto& voxel = row[static_cast<std::size_t>(z)];
            const auto own = voxel;
            Blend<Value> blend;
            const auto& place = found_.places[static_cast<std::size_t>(z)];
            const auto all = [](const Value& got) { return got; };
            Reader<Value, decltype(all)> read(*this, first.offsetBy(0, 0, z).asVec3d(), place, own.value, own.on, all);
            gather<Value>(map_.steps().size(), place.at, 1.0, grid_.background(), blend, read);
            voxel = {blend.value(), blend.on()};
        }
    }

    /// Component c of a staggered grid stands half a voxel below its voxel's centre along axis c.
    void carve_faces(const Coord& first, std::array<Voxel, 8>& row) {
        using Element = typename openvdb::VecTraits<Value>::ElementType;
        const auto own = row;
        for (auto& voxel : row) voxel.on = false;
        for (int c = 0; c < 3; ++c) {
            Vec3d offset(0);
            offset[c] = -0.5;
            places_.locate(first, offset, found_);
            for (int z = 0; z < 8; ++z) {
                auto& voxel = row[static_cast<std::size_t>(z)];
                const auto& before = own[static_cast<std::size_t>(z)];
                if ((found_.inside >> z & 1) == 0) {
                    voxel.on = voxel.on || before.on;
                    continue;
                }
                Blend<Element> blend;
                const auto& place = found_.places[static_cast<std::size_t>(z)];
                const auto component = [c](const Value& got) { return got[c]; };
                Reader<Element, decltype(component)> read(*this, first.offsetBy(0, 0, z).asVec3d(), place, before.value[c], before.on, component);
                gather<Element>(map_.steps().size(), place.at, 1.0, grid_.background()[c], blend, read);
                voxel.value[c] = blend.value();
                voxel.on = voxel.on || blend.on();
            }
        }
    }

    /// Reads the field displaced by `G(l') - G(l)` from voxel position `p`; undisplaced, the voxel's own value. Columns
    /// that move alike ask for the same position: the last few are kept.
    template <class Part, class Pick>
    class Reader {
    public:
        Reader(Worker& worker, const Vec3d& p, const BlockPlaces::Place& place, const Part& own, bool own_on, Pick pick)
            : worker_(worker), p_(p), place_(place), own_{own, own_on}, pick_(pick) {}
        std::pair<Part, bool> operator()(const Vec3d& source) {
            if (source == place_.at) return own_;
            for (std::size_t n = 0; n < std::min(count_, kept_.size()); ++n)
                if (kept_[n].source == source) return kept_[n].read;
            auto& next = kept_[count_++ % kept_.size()];
            next = {source, worker_.read(worker_.places_.moved(p_, place_, source), pick_)};
            return next.read;
        }

    private:
        struct Kept {
            Vec3d source;
            std::pair<Part, bool> read;
        };
        Worker& worker_;
        const Vec3d p_;
        const BlockPlaces::Place& place_;
        const std::pair<Part, bool> own_;
        const Pick pick_;
        std::array<Kept, 4> kept_;
        std::size_t count_ = 0;
    };

    /// Value and state at index coordinates.
    template <class Pick>
    auto read(const Vec3d& at, const Pick& pick) {
        const auto q = snapped(at);
        const auto nearest = nearest_voxel(q);
        if constexpr (can_blend<Value>) {
            using Sampler = openvdb::tools::BoxSampler;
            const auto low = voxel_below(q);
            // Mostly all that is read stands in one leaf of the window.
            if (interpolation_ == Interpolation::linear && in_one_leaf(low) && window_.holds(low)) {
                const auto& cell = window_.cell_of(low);
                if (!cell.leaf) return std::pair(pick(cell.tile.value), cell.tile.on);
                Value values[2][2][2];
                read_cell(*cell.leaf, low, values);
                return std::pair(pick(Sampler::trilinearInterpolation(values, q - low.asVec3d())), cell.leaf->isValueOn(nearest));
            }
        }
        return std::pair(pick(sample(q, nearest)), window_.holds(nearest) ? window_.get(nearest).on : values_.isValueOn(nearest));
    }

    Value sample(const Vec3d& q, const Coord& nearest) {
        if constexpr (can_blend<Value>) {
            if (q != nearest.asVec3d()) {
                switch (interpolation_) {
                    case Interpolation::linear: return openvdb::tools::BoxSampler::sample(values_, q);
                    case Interpolation::quadratic: return openvdb::tools::QuadraticSampler::sample(values_, q);
                    case Interpolation::cubic: return sample_cubic<Value>(values_, q);
                }
            }
        }
        return window_.holds(nearest) ? window_.get(nearest).value : values_.getValue(nearest);
    }

    /// Adds, with a weight, what stands at lattice coordinates `l` after the first `count` steps.
    template <class Part, class Read>
    void gather(std::size_t count, Vec3d l, double weight, const Part& nothing, Blend<Part>& out, Read& read) {
        for (; count > 0; --count) {
            const auto& step = map_.steps()[count - 1];
            const int axis = step.axis();
            const double u = l[axis], v = l[step.lateral_axis()];
            if (u < 0 || u > step.reach() - 1 || v < 0 || v > step.laterals() - 1) continue;
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
    BlockPlaces places_;
    BlockPlaces::Row found_;
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
    const BlockPlaces places(mapping, grid->transform());
    return rewrite_blocks<GridT>(grid, box, [&] {
        return [worker = std::make_shared<Worker<GridT>>(*grid, mapping, places, map, interpolation)](const Coord& block, LeafOf<GridT>& out) {
            return (*worker)(block, out);
        };
    });
}

#define FLUIDCARVE_INSTANTIATE(GridT) template GridT::ConstPtr carve_sampled<GridT>(const GridT::ConstPtr&, const Mapping&, const CarveMap&, Interpolation);
FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_INSTANTIATE)
#undef FLUIDCARVE_INSTANTIATE

}  // namespace fluidcarve
