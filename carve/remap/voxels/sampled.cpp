#include "carve/remap/voxels/sampled.h"

#include "carve/field/extent.h"
#include "carve/lattice/block_places.h"
#include "carve/remap/voxels/blend.h"
#include "carve/remap/voxels/blocks.h"
#include "carve/remap/voxels/carve_block.h"
#include "carve/remap/voxels/joined_reader.h"
#include "carve/remap/voxels/slow_part.h"
#include "carve/remap/voxels/source_blend.h"
#include "carve/remap/voxels/voxel_reader.h"
#include "carve/seam/joins.h"
#include "carve/volume/grid_types.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>

namespace fluidcarve {

namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

/// Voxels on each side of a position that linear interpolation reads. Other interpolations read
/// further voxels by a search.
constexpr int support = 1;

/// Carves a grid block by block, by sampling it.
template <class GridT>
class SampledCarve {
    using TreeT = typename GridT::TreeType;
    using Leaf = typename TreeT::LeafNodeType;
    using Value = typename TreeT::ValueType;
    template <class Part>
    using Row = typename VoxelReader<GridT>::template Row<Part>;
    static constexpr bool is_vector = openvdb::VecTraits<Value>::IsVec;

public:
    /// @param slow  the grid's slow part; null: sides are only faded
    SampledCarve(const GridT& grid, const Mapping& mapping, const BlockPlaces& places,
                 const CarveMap& map, Interpolation interpolation, const GridT* unfaded,
                 const std::shared_ptr<const SlowPart>& slow)
        : grid_(grid),
          map_(map),
          places_(places),
          block_(map),
          staggered_(grid.getGridClass() == openvdb::GRID_STAGGERED),
          blocks_(grid.tree()),
          reader_(grid, interpolation) {
        if (unfaded) unfaded_.emplace(unfaded->tree());
        if (map.joins()) joined_.emplace(grid, mapping, places_, JoinedSides(map, block_), slow);
    }
    SampledCarve(const SampledCarve&) = delete;
    SampledCarve& operator=(const SampledCarve&) = delete;

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
        reader_.move_to(blocks_, sources);

        for (openvdb::Index n = 0; n < Leaf::SIZE; n += 8) {
            const auto first = out.offsetToGlobalCoord(n);
            Row<Value> row;
            blocks_.read(first, row);
            carve(first, row);
            blocks_.write(out, n, row);
        }
        return true;
    }

private:
    void carve(const Coord& first, Row<Value>& row) {
        if constexpr (is_vector && can_blend<Value>)
            if (staggered_) return carve_faces(first, row);
        carve_centres(first, row);
    }

    void carve_centres(const Coord& first, Row<Value>& row) {
        const auto faded = carve_row(first, WholeValue<Value>{}, row);
        if (!unfaded_) return;
        const auto carved = row;
        unfaded_->read(first, row);
        for (std::size_t z = 0; z < 8; ++z)
            if ((faded >> z & 1) != 0) row[z] = carved[z];
    }

    void carve_faces(const Coord& first, Row<Value>& row) {
        using Pick = OneComponent<Value>;
        const auto own = row;
        if (unfaded_) unfaded_->read(first, row);
        const auto cut = row;
        for (auto& voxel : row) voxel.on = false;
        for (std::size_t component = 0; component < 3; ++component) {
            const Pick pick{component};
            Row<typename Pick::Part> parts;
            for (std::size_t z = 0; z < 8; ++z) parts[z] = {pick(own[z].value), own[z].on};
            const auto faded = carve_row(first, pick, parts);
            for (std::size_t z = 0; z < 8; ++z) {
                const bool taken = !unfaded_ || (faded >> z & 1) != 0;
                if (taken) row[z].value[static_cast<int>(component)] = parts[z].value;
                row[z].on = row[z].on || (taken ? parts[z].on : cut[z].on);
            }
        }
    }

    /// Carves a row of voxels: whole values, or one component of them.
    /// @return bit z is set if a fade of rims scaled a displacement of voxel z
    template <class Pick>
    unsigned carve_row(const Coord& first, const Pick& pick, Row<typename Pick::Part>& row) {
        if (places_.interior() && block_.rigid() && block_.rigid()->z() == 0) {
            const auto inside = places_.shift(first, pick.offset(), *block_.rigid(), positions_);
            reader_.read(inside, positions_, pick, row);
            return 0;
        }
        places_.locate(first, pick.offset(), found_);
        unsigned moved = 0, faded = 0;
        for (std::size_t z = 0; z < 8; ++z) {
            if ((found_.inside >> z & 1) == 0) continue;
            const auto p = first.offsetBy(0, 0, static_cast<int>(z)).asVec3d();
            const auto& place = found_.places[z];
            // Voxels that only move are read together.
            const auto move = [&](const Vec3d& to) {
                positions_.set(z, to);
                moved |= 1u << z;
            };
            if (joined_) {
                joined_->move_to(p, place);
                if (!joined_->rigid()) row[z] = joined_->blend(reader_, pick, row[z]);
                else if (joined_->source() != place.at) move(joined_->position(joined_->source()));
            } else if (const auto rigid = block_.rigid_at(place.at)) {
                if (rigid->fades) faded |= 1u << z;
                if (rigid->by != Vec3d(0)) move(places_.moved(p, place, rigid->by));
            } else if (blend_sources(p, place, pick, row[z])) {
                faded |= 1u << z;
            }
        }
        reader_.read(moved, positions_, pick, row);
        return faded;
    }

    /// Carves a voxel in a cell whose corners move differently.
    /// @return whether a fade of rims scaled a displacement
    template <class Pick, class Part = typename Pick::Part>
    bool blend_sources(const Vec3d& p, const BlockPlaces::Place& place, const Pick& pick,
                       ValueAndState<Part>& voxel) {
        const Part nothing = pick(grid_.background());
        const auto read = [&](const Vec3d& source) {
            if (source == place.at) return voxel;
            return reader_.read(places_.moved(p, place, source - place.at), pick);
        };
        SourceBlend<Part, decltype(read)> sources(map_, block_, nothing, read);
        sources.add(map_.steps().size(), place.at, 1);
        voxel = sources.result();
        return sources.fades();
    }

    const GridT& grid_;
    const CarveMap& map_;
    BlockPlaces places_;
    CarveBlock block_;
    const bool staggered_;
    BlockWindow<TreeT> blocks_;
    std::optional<BlockWindow<TreeT>> unfaded_;
    VoxelReader<GridT> reader_;
    std::optional<JoinedReader<GridT>> joined_;  ///< if the map's seams are joined by fades
    BlockPlaces::Row found_;                     ///< of a row
    BlockPlaces::Positions positions_;           ///< at which voxels of a row are read
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
