#include "carve/remap/finish/level_set.h"

#include "carve/field/extent.h"
#include "carve/remap/voxels/blocks.h"
#include "carve/remap/voxels/seam_cells.h"

#include <openvdb/tools/LevelSetTracker.h>

#include <cmath>
#include <cstddef>
#include <memory>

namespace fluidcarve {

namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

/// Bit z is set if voxel z of a row moved.
unsigned moved_voxels(CarvedPlaces& places, CarvedPlaces::Row& row, const CarveMap& map,
                      const Coord& first) {
    places.locate(first, Vec3d(0), row);
    unsigned out = 0;
    for (std::size_t z = 0; z < 8; ++z)
        if ((row.inside >> z & 1) != 0 && is_moved(map, row.at[z])) out |= 1u << z;
    return out;
}

/// Makes every moved voxel active that has a face neighbour of the other sign. Where a carve
/// removed the whole narrow band, nothing else shows where the surface is.
template <class GridT>
typename GridT::ConstPtr with_surface(const typename GridT::ConstPtr& grid,
                                      const CarvedPlaces& places, const CarveMap& map,
                                      const CoordBBox& box) {
    struct Worker {
        const CarveMap& map;
        CarvedPlaces places;
        BlockWindow<typename GridT::TreeType> window;
        CarvedPlaces::Row row{};

        bool operator()(const Coord& block, LeafOf<GridT>& out) {
            window.move_to(CoordBBox::createCube(block.offsetBy(-1), 10));
            if (window.uniform()) return false;
            window.read(out);
            places.move_to(block);
            for (openvdb::Index n = 0; n < LeafOf<GridT>::SIZE; n += 8) {
                unsigned crossed = 0;
                for (openvdb::Index z = 0; z < 8; ++z)
                    if (!out.isValueOn(n + z) && crosses(out.offsetToGlobalCoord(n + z)))
                        crossed |= 1u << z;
                if (crossed == 0) continue;
                crossed &= moved_voxels(places, row, map, out.offsetToGlobalCoord(n));
                for (openvdb::Index z = 0; z < 8; ++z)
                    if ((crossed >> z & 1) != 0) out.setValueOn(n + z);
            }
            return true;
        }
        bool crosses(const Coord& at) const {
            const bool inside = window.get(at).value < 0;
            for (int axis = 0; axis < 3; ++axis)
                for (const int step : {-1, 1}) {
                    auto beside = at;
                    beside[axis] += step;
                    if ((window.get(beside).value < 0) != inside) return true;
                }
            return false;
        }
    };
    return rewrite_blocks<GridT>(grid, box, [&] {
        return [worker = std::make_shared<Worker>(
                    Worker{map, places, BlockWindow<typename GridT::TreeType>(grid->tree())})](
                   const Coord& block, LeafOf<GridT>& out) { return (*worker)(block, out); };
    });
}

template <class GridT>
openvdb::GridBase::ConstPtr renormalize(const openvdb::GridBase::ConstPtr& base,
                                        const CarvedPlaces& places, const CarveMap& map) {
    using Tracker = openvdb::tools::LevelSetTracker<GridT>;
    using Mask = typename Tracker::MaskTreeType;
    using Value = typename GridT::ValueType;
    const auto grid = openvdb::GridBase::grid<GridT>(base);
    const auto background = grid->background();
    const int half_width = static_cast<int>(std::ceil(background / grid->voxelSize()[0]));
    const auto box = places.voxels(map.moved());

    const openvdb::GridBase::ConstPtr start = with_surface<GridT>(grid, places, map, box);
    const auto distance = openvdb::GridBase::grid<GridT>(start->deepCopyGrid());
    Tracker tracker(*distance);
    openvdb::tools::dilateActiveValues(tracker.leafs(), half_width, openvdb::tools::NN_FACE,
                                       openvdb::tools::IGNORE_TILES);
    Mask moved(distance->tree(), false, openvdb::TopologyCopy());
    openvdb::tree::LeafManager<Mask>(moved).foreach (
        [&](typename Mask::LeafNodeType& leaf, std::size_t) {
            auto own = places;
            CarvedPlaces::Row row;
            own.move_to(leaf.origin());
            for (openvdb::Index n = 0; n < leaf.SIZE; n += 8) {
                const auto voxels = moved_voxels(own, row, map, leaf.offsetToGlobalCoord(n));
                for (openvdb::Index z = 0; z < 8; ++z)
                    if ((voxels >> z & 1) == 0) leaf.setValueOff(n + z);
            }
        });
    // One iteration carries distances 0.3 voxels further. This number carries them across the band.
    tracker.setTemporalScheme(openvdb::math::TVD_RK1);
    tracker.setNormCount(static_cast<int>(std::ceil(2 * half_width / 0.3)));
    tracker.normalize(&moved);

    return rewrite_blocks<GridT>(grid, box, [&] {
        return [&, window = BlockWindow<typename GridT::TreeType>(grid->tree())](
                   const Coord& block, LeafOf<GridT>& out) mutable {
            const auto* const mask = moved.probeConstLeaf(block);
            if (!mask || mask->isEmpty()) return false;
            window.move_to(CoordBBox::createCube(block, 8));
            window.read(out);
            const auto& values = *distance->tree().probeConstLeaf(block);
            for (auto voxel = mask->cbeginValueOn(); voxel; ++voxel) {
                const Value value = values.getValue(voxel.pos());
                if (std::abs(value) < background) out.setValueOn(voxel.pos(), value);
                else out.setValueOff(voxel.pos(), value < 0 ? -background : background);
            }
            return true;
        };
    });
}

}  // namespace

bool can_renormalize(const openvdb::GridBase& grid) {
    if (grid.getGridClass() != openvdb::GRID_LEVEL_SET || !grid.hasUniformVoxels()) return false;
    constexpr double widest_band = 100;  // voxels on each side
    const auto has_band = [&](double background) {
        return background > 0 && background <= widest_band * grid.voxelSize()[0];
    };
    if (grid.isType<openvdb::FloatGrid>())
        return has_band(static_cast<const openvdb::FloatGrid&>(grid).background());
    return grid.isType<openvdb::DoubleGrid>() &&
           has_band(static_cast<const openvdb::DoubleGrid&>(grid).background());
}

openvdb::GridBase::ConstPtr renormalized(const openvdb::GridBase::ConstPtr& grid,
                                         const CarvedPlaces& places, const CarveMap& map) {
    if (map.empty()) return grid;
    require_near(grid->getName(), grid->evalActiveVoxelBoundingBox());
    if (grid->isType<openvdb::FloatGrid>())
        return renormalize<openvdb::FloatGrid>(grid, places, map);
    return renormalize<openvdb::DoubleGrid>(grid, places, map);
}

}  // namespace fluidcarve
