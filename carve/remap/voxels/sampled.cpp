#include "carve/remap/voxels/sampled.h"

#include "carve/field/extent.h"
#include "carve/lattice/block_places.h"
#include "carve/remap/voxels/blend.h"
#include "carve/remap/voxels/blocks.h"
#include "carve/remap/voxels/carve_block.h"
#include "carve/remap/voxels/cubic.h"
#include "carve/remap/voxels/joined_sides.h"
#include "carve/remap/voxels/slow_part.h"
#include "carve/remap/voxels/windows.h"
#include "carve/seam/joins.h"
#include "carve/volume/grid_types.h"

#include <openvdb/tools/Interpolation.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

namespace fluidcarve {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

/// Voxels on each side of a position that linear interpolation reads. Other interpolations read
/// further voxels by a search.
constexpr int support = 1;
/// Largest number of voxels that are copied for a block of 512. If a block reads more, they are
/// read one by one.
constexpr std::size_t most_copied = 32 * 512;

/// Carves a grid block by block, by sampling it.
template <class GridT>
class SampledCarve {
    using TreeT = typename GridT::TreeType;
    using Leaf = typename TreeT::LeafNodeType;
    using Value = typename TreeT::ValueType;
    static constexpr bool is_vector = openvdb::VecTraits<Value>::IsVec;

public:
    /// @param slow  the grid's slow part; null: sides are only faded
    SampledCarve(const GridT& grid, const Mapping& mapping, const BlockPlaces& places,
                 const CarveMap& map, Interpolation interpolation, const GridT* unfaded,
                 std::shared_ptr<const SlowPart> slow)
        : slow_(std::move(slow)),
          joins_(map.joins()),
          grid_(grid),
          places_(places),
          map_(map),
          block_(map),
          interpolation_(interpolation),
          staggered_(is_vector && can_blend<Value> &&
                     grid.getGridClass() == openvdb::GRID_STAGGERED),
          blocks_(grid.tree()),
          values_(grid.getConstAccessor()) {
        if (unfaded) unfaded_.emplace(unfaded->tree());
        if (mapping.slabs()) return;
        const auto at = [&](const Vec3d& vertex) {
            return grid.transform().worldToIndex(mapping.position(vertex));
        };
        steps_ = {at(Vec3d(1, 0, 0)) - at(Vec3d(0)), at(Vec3d(0, 1, 0)) - at(Vec3d(0)),
                  at(Vec3d(0, 0, 1)) - at(Vec3d(0))};
    }

    bool operator()(const Coord& block, Leaf& out) {
        if (!block_.move_to(places_.move_to(block)) || (unfaded_ && !block_.rims_fade()))
            return false;
        auto sources = places_.reach(block_.least(), block_.most());
        sources.expand(support);
        auto all = sources;
        all.expand(CoordBBox::createCube(block, 8));
        blocks_.move_to(all);
        if (blocks_.uniform() &&
            (!block_.frees() ||
             (!blocks_.tile().on && same_bits(blocks_.tile().value, grid_.background()))))
            return false;
        if (unfaded_) unfaded_->move_to(CoordBBox::createCube(block, 8));
        if (sources.volume() <= most_copied) window_.move_to(blocks_, sources);
        else window_.clear();

        for (openvdb::Index n = 0; n < Leaf::SIZE; n += 8) {
            const auto first = out.offsetToGlobalCoord(n);
            std::array<Voxel, 8> row;
            blocks_.read(first, row);
            if constexpr (is_vector && can_blend<Value>) {
                if (staggered_) carve_faces(first, row);
                else carve_centres(first, row);
            } else {
                carve_centres(first, row);
            }
            blocks_.write(out, n, row);
        }
        return true;
    }

private:
    using Voxel = typename BlockWindow<TreeT>::Voxel;

    template <class Part>
    using Parts = std::array<std::pair<Part, bool>, 8>;

    void carve_centres(const Coord& first, std::array<Voxel, 8>& row) {
        Parts<Value> parts;
        for (std::size_t z = 0; z < 8; ++z) parts[z] = {row[z].value, row[z].on};
        const auto faded = carve_row(
            first, Vec3d(0), grid_.background(), 0, [](const Value& got) { return got; }, parts);
        if (unfaded_) unfaded_->read(first, row);
        for (std::size_t z = 0; z < 8; ++z)
            if (!unfaded_ || (faded >> z & 1) != 0) row[z] = {parts[z].first, parts[z].second};
    }

    /// Component c of a staggered grid stands half a voxel below its voxel's centre along axis c.
    void carve_faces(const Coord& first, std::array<Voxel, 8>& row) {
        using Element = typename openvdb::VecTraits<Value>::ElementType;
        const auto own = row;
        if (unfaded_) unfaded_->read(first, row);
        const auto cut = row;
        for (auto& voxel : row) voxel.on = false;
        for (int c = 0; c < 3; ++c) {
            Vec3d offset(0);
            offset[c] = -0.5;
            Parts<Element> parts;
            for (std::size_t z = 0; z < 8; ++z) parts[z] = {own[z].value[c], own[z].on};
            const auto faded = carve_row(
                first, offset, grid_.background()[c], static_cast<std::size_t>(c),
                [c](const Value& got) { return got[c]; }, parts);
            for (std::size_t z = 0; z < 8; ++z) {
                const bool taken = !unfaded_ || (faded >> z & 1) != 0;
                if (taken) row[z].value[c] = parts[z].first;
                row[z].on = row[z].on || (taken ? parts[z].second : cut[z].on);
            }
        }
    }

    /// Carves a row of voxels: whole values, or one component of them.
    /// @param offset   from a voxel to the position of the part, voxels
    /// @param nothing  the background's part
    /// @param component  of the part, or the first of them
    /// @param parts    values and states before; become the carved ones
    /// @return bit z is set if a fade scaled a displacement of voxel z
    template <class Part, class Pick>
    unsigned carve_row(const Coord& first, const Vec3d& offset, const Part& nothing,
                       std::size_t component, const Pick& pick, Parts<Part>& parts) {
        if (places_.interior() && block_.rigid() && block_.rigid()->z() == 0) {
            read_row(places_.shift(first, offset, *block_.rigid(), positions_), pick, parts);
            return 0;
        }
        places_.locate(first, offset, found_);
        unsigned moved = 0, faded = 0;
        for (int z = 0; z < 8; ++z) {
            if ((found_.inside >> z & 1) == 0) continue;
            const auto p = first.offsetBy(0, 0, z).asVec3d();
            const auto& place = found_.places[static_cast<std::size_t>(z)];
            if (joins_) {
                sides_.find(place.at);
                if (sides_.rigid()) {
                    if (sides_.stretched() == place.at) continue;
                    positions_.set(static_cast<std::size_t>(z),
                                   position(p, place, sides_.stretched()));
                    moved |= 1u << z;
                    continue;
                }
                parts[static_cast<std::size_t>(z)] = joined<Part>(
                    p, place, nothing, component, pick, parts[static_cast<std::size_t>(z)]);
                continue;
            }
            if (const auto rigid = block_.rigid_at(place.at)) {
                if (rigid->fades) faded |= 1u << z;
                if (rigid->by == Vec3d(0)) continue;
                positions_.set(static_cast<std::size_t>(z), places_.moved(p, place, rigid->by));
                moved |= 1u << z;
                continue;
            }
            fades_ = false;
            Blend<Part> blend;
            auto& part = parts[static_cast<std::size_t>(z)];
            Reader<Part, Pick> read(*this, p, place, part, pick);
            gather<Part>(map_.steps().size(), place.at, 1.0, nothing, blend, read);
            part = {blend.value(), blend.on(nothing)};
            if (fades_) faded |= 1u << z;
        }
        read_row(moved, pick, parts);
        return faded;
    }

    /// The position at which a voxel reads the content of other lattice coordinates. In a straight
    /// box all steps are equal.
    Vec3d position(const Vec3d& p, const BlockPlaces::Place& place, const Vec3d& source) const {
        const auto by = source - place.at;
        return steps_ ? p + by.x() * (*steps_)[0] + by.y() * (*steps_)[1] + by.z() * (*steps_)[2]
                      : places_.moved(p, place, by);
    }

    /// The value and state of a point, from its sides (METHOD 10 "Joins").
    template <class Part, class Pick>
    std::pair<Part, bool> joined(const Vec3d& p, const BlockPlaces::Place& place,
                                 const Part& nothing, std::size_t component, const Pick& pick,
                                 const std::pair<Part, bool>& own) {
        if (sides_.freed()) return {nothing, false};
        Blend<Part> blend;
        TwoBands<Part> bands{};
        bool any = false;
        const auto met = [&](const Part& value, bool on) {
            if constexpr (std::is_floating_point_v<Part>)
                bands.highest = std::max(bands.highest, std::abs(static_cast<double>(value)));
            any = any || on;
        };
        const auto slow_part = [&](const Vec3d& at) {
            std::array<double, 3> out{};
            for (std::size_t c = 0; c < components_of<Part>; ++c)
                out[c] = slow_->at(at, component + c);
            return out;
        };
        if constexpr (can_blend<Part>) {
            if (slow_) {
                const auto at = position(p, place, sides_.stretched());
                const auto [value, on] = read(at, pick);
                met(bands.stretched = value, on);
                bands.wanted = slow_part(at);
            }
        }
        for (const auto& side : sides_.all()) {
            const auto at = position(p, place, side.at);
            const auto [value, on] = side.nothing          ? std::pair(nothing, false)
                                     : side.at == place.at ? own
                                                           : read(at, pick);
            blend.add(value, on, side.weight);
            met(value, on);
            if constexpr (can_blend<Part>) {
                if (!slow_ || side.nothing) continue;
                const auto slow = slow_part(at);
                for (std::size_t c = 0; c < components_of<Part>; ++c)
                    bands.shown[c] += side.weight * slow[c];
                bands.stretch += side.weight * misfit({slow, components(value)},
                                                      {bands.wanted, components(bands.stretched)});
                bands.squares += side.weight * side.weight;
            }
        }
        bands.faded = blend.value();
        if constexpr (can_blend<Part>) {
            // Most of a box is empty.
            const bool empty = bands.faded == nothing && (!slow_ || bands.stretched == nothing);
            auto value = !slow_ || empty ? bands.faded : bands.value();
            if (!openvdb::math::isFinite(value)) value = blend.value();
            return {value, blend.on(nothing) || (any && !empty && value != nothing)};
        } else {
            return {bands.faded, blend.on(nothing)};
        }
    }

    /// Reads the values at positions_.
    /// @param lanes  bit z is set if voxel z is read
    template <class Part, class Pick>
    void read_row(unsigned lanes, const Pick& pick, Parts<Part>& parts) {
        if constexpr (can_blend<Value>) {
            if (interpolation_ == Interpolation::linear && lanes != 0) {
                // Lanes that are not read need some valid position.
                for (auto idle = ~lanes & 0xff; idle != 0; idle &= idle - 1)
                    positions_.set(
                        static_cast<std::size_t>(std::countr_zero(idle)),
                        positions_.at(static_cast<std::size_t>(std::countr_zero(lanes))));
                window_.find(positions_.xyz, cells_);
                if (cells_.held) {
                    for (std::size_t z = 0; z < 8; ++z) {
                        if ((lanes >> z & 1) == 0) continue;
                        parts[z] =
                            with_state(window_.between(static_cast<std::size_t>(cells_.lowest[z]),
                                                       cells_.t(z), pick),
                                       static_cast<std::size_t>(cells_.nearest[z]), pick);
                    }
                    return;
                }
            }
        }
        for (; lanes != 0; lanes &= lanes - 1) {
            const auto z = static_cast<std::size_t>(std::countr_zero(lanes));
            parts[z] = read(positions_.at(z), pick);
        }
    }

    /// Reads the grid at voxel position `p` displaced by `G(l') - G(l)`; without displacement, the
    /// voxel's own value. Columns that move equally ask for the same position, so the last few
    /// results are kept.
    template <class Part, class Pick>
    class Reader {
    public:
        Reader(SampledCarve& worker, const Vec3d& p, const BlockPlaces::Place& place,
               const std::pair<Part, bool>& own, const Pick& pick)
            : worker_(worker), p_(p), place_(place), own_(own), pick_(pick) {}
        std::pair<Part, bool> operator()(const Vec3d& source) {
            if (source == place_.at) return own_;
            for (std::size_t n = 0; n < std::min(count_, kept_.size()); ++n)
                if (kept_[n].source == source) return kept_[n].read;
            auto& next = kept_[count_++ % kept_.size()];
            next = {source,
                    worker_.read(worker_.places_.moved(p_, place_, source - place_.at), pick_)};
            return next.read;
        }

    private:
        struct Kept {
            Vec3d source;
            std::pair<Part, bool> read;
        };

        SampledCarve& worker_;
        const Vec3d p_;
        const BlockPlaces::Place& place_;
        const std::pair<Part, bool> own_;
        const Pick& pick_;
        std::array<Kept, 4> kept_;
        std::size_t count_ = 0;
    };

    /// Value and state at index coordinates.
    template <class Pick>
    auto read(const Vec3d& at, const Pick& pick) {
        using Part = std::decay_t<decltype(pick(std::declval<Value>()))>;
        const auto q = snapped(at);
        typename VoxelWindow<TreeT>::Cell cell;
        if (!window_.find(q, cell)) return read_far(q, pick);
        if constexpr (can_blend<Value>) {
            if (interpolation_ == Interpolation::linear)
                return with_state(window_.between(cell.lowest, cell.t, pick), cell.nearest, pick);
            if (cell.t != Vec3d(0))
                return with_state(pick(sample(q, nearest_to(q))), cell.nearest, pick);
        }
        return std::pair<Part, bool>(pick(window_.value(cell.nearest)), window_.on(cell.nearest));
    }
    /// The same outside the window.
    template <class Pick>
    auto read_far(const Vec3d& q, const Pick& pick) {
        using Part = std::decay_t<decltype(pick(std::declval<Value>()))>;
        const auto nearest = nearest_to(q);
        Part value = pick(sample(q, nearest));
        if constexpr (can_blend<Part>)
            if (!openvdb::math::isFinite(value)) value = pick(values_.getValue(nearest));
        return std::pair<Part, bool>(
            value, values_.isValueOn(nearest) || shows<Part>(value, pick(values_.getValue(nearest)),
                                                             pick(grid_.background())));
    }
    /// A value between the voxels of the window, and whether it is active.
    /// @param nearest  place of the nearest voxel
    template <class Part, class Pick>
    std::pair<Part, bool> with_state(Part value, std::size_t nearest, const Pick& pick) const {
        if constexpr (can_blend<Part>)
            if (!openvdb::math::isFinite(value)) value = pick(window_.value(nearest));
        return {value, window_.on(nearest) || shows<Part>(value, pick(window_.value(nearest)),
                                                          pick(grid_.background()))};
    }
    static Coord nearest_to(const Vec3d& q) {
        const auto low = voxel_below(q);
        const auto t = q - low.asVec3d();
        return {low.x() + (t.x() >= 0.5), low.y() + (t.y() >= 0.5), low.z() + (t.z() >= 0.5)};
    }

    Value sample(const Vec3d& q, const Coord& nearest) {
        if constexpr (can_blend<Value>) {
            if (q != nearest.asVec3d()) {
                switch (interpolation_) {
                    case Interpolation::linear:
                        return openvdb::tools::BoxSampler::sample(values_, q);
                    case Interpolation::quadratic:
                        return openvdb::tools::QuadraticSampler::sample(values_, q);
                    case Interpolation::cubic: return sample_cubic<Value>(values_, q);
                }
            }
        }
        return values_.getValue(nearest);
    }

    /// Adds the content at lattice coordinates `l` after the first `count` steps, with a weight.
    template <class Part, class Read>
    void gather(std::size_t count, Vec3d l, double weight, const Part& nothing, Blend<Part>& out,
                Read& read) {
        for (; count > 0; --count) {
            const auto& step = map_.steps()[count - 1];
            const int axis = step.axis();
            const double u = l[axis];
            if (!step.holds(l)) continue;
            const double scale = step.rim_scale(l);
            if (scale < 1) fades_ = true;
            if (!step.carves(l, scale)) {
                if (!step.frees(l)) continue;
                return out.add(nothing, false, weight);
            }
            if (step.soft()) {
                l[axis] = step.clamped(u + scale * block_.smooth(count - 1, l));
                continue;
            }

            const auto from = [&](double entry, int displacement, double share) {
                const auto at = [&](int even, double part) {
                    auto source = l;
                    source[axis] = step.faded_source(u, entry + 0.5 * even, scale);
                    if (count > 1) return gather(count - 1, source, part, nothing, out, read);
                    const auto [value, on] = read(source);
                    out.add(value, on, part);
                };
                if (displacement % 2 == 0) return at(displacement, share);
                // An inserted entry is the mean of its neighbours, whatever the interpolation.
                at(displacement - 1, share / 2);
                at(displacement + 1, share / 2);
            };
            const auto cell = block_.cell(count - 1, l);
            if (cell.rigid) {
                if (cell.columns[0].low % 2 != 0) return from(u, cell.columns[0].low, weight);
                l[axis] = step.faded_source(u, u + 0.5 * cell.columns[0].low, scale);
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

    const std::shared_ptr<const SlowPart> slow_;
    const bool joins_;
    /// In a straight box: from a vertex to the next along u, v and w, voxels.
    std::optional<std::array<Vec3d, 3>> steps_;
    const GridT& grid_;
    BlockPlaces places_;
    BlockPlaces::Row found_;
    BlockPlaces::Positions positions_;
    const CarveMap& map_;
    CarveBlock block_;
    JoinedSides sides_{map_, block_};  ///< of the last point
    bool fades_ = false;               ///< whether gather met a scale below 1
    const Interpolation interpolation_;
    const bool staggered_;
    BlockWindow<TreeT> blocks_;
    std::optional<BlockWindow<TreeT>> unfaded_;
    VoxelWindow<TreeT> window_;
    typename VoxelWindow<TreeT>::Cells cells_;
    typename GridT::ConstAccessor values_;
};

/// The part of a grid that is squeezed or stretched at joins instead of faded; null if there is
/// none. Distances are only faded.
template <class GridT>
std::shared_ptr<const SlowPart> slow_part(const GridT& grid, const Mapping& mapping,
                                          const CarveMap& map) {
    if constexpr (can_blend<typename GridT::ValueType>) {
        constexpr double sigma_of_fade = 1.0 / 4;
        double fade = 0;
        for (const auto& step : map.steps())
            if (step.joins()) fade = std::max(fade, step.joins()->fade());
        const double spacing =
            (mapping.position(Vec3d(1, 0, 0)) - mapping.position(Vec3d(0))).length();
        if (fade > 0 && grid.getGridClass() != openvdb::GRID_LEVEL_SET)
            return std::make_shared<const SlowPart>(
                grid, sigma_of_fade * fade * spacing / grid.voxelSize().x());
    }
    return nullptr;
}

}  // namespace

template <class GridT>
typename GridT::ConstPtr carve_sampled(const typename GridT::ConstPtr& grid, const Mapping& mapping,
                                       const CarveMap& map, Interpolation interpolation,
                                       const typename GridT::ConstPtr& unfaded) {
    if (map.empty()) return grid;
    // A component's face may lie in the lattice where its voxel's centre does not.
    const auto box =
        padded(voxels_around(mapping.world_box(map.moved()), grid->transform(), "the lattice"), 1);
    const BlockPlaces places(mapping, grid->transform());
    const auto slow = slow_part(*grid, mapping, map);
    return rewrite_blocks<GridT>(unfaded ? unfaded : grid, box, [&] {
        return block_worker<GridT, SampledCarve<GridT>>(*grid, mapping, places, map, interpolation,
                                                        unfaded.get(), slow);
    });
}

#define FLUIDCARVE_INSTANTIATE(GridT)                                                     \
    template GridT::ConstPtr carve_sampled<GridT>(const GridT::ConstPtr&, const Mapping&, \
                                                  const CarveMap&, Interpolation,         \
                                                  const GridT::ConstPtr&);
FLUIDCARVE_EACH_GRID_TYPE(FLUIDCARVE_INSTANTIATE)
#undef FLUIDCARVE_INSTANTIATE

}  // namespace fluidcarve
