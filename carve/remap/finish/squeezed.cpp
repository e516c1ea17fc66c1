#include "carve/remap/finish/squeezed.h"

#include "carve/remap/voxels/blocks.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace fluidcarve {

namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

/// Smooths block by block.
template <class GridT>
class SqueezedSmooth {
public:
    SqueezedSmooth(const GridT& grid, CarvedPlaces places, const CarveDerivative& derivative)
        : derivative_(derivative), places_(std::move(places)), window_(grid.tree()) {}

    bool operator()(const Coord& block, LeafOf<GridT>& out) {
        if (places_.move_to(block).empty()) return false;
        window_.move_to(CoordBBox::createCube(block.offsetBy(-2), 12));
        if (window_.uniform()) return false;
        window_.read(out);
        bool changed = false;
        for (openvdb::Index n = 0; n < LeafOf<GridT>::SIZE; n += 8) {
            places_.locate(out.offsetToGlobalCoord(n), Vec3d(0), row_);
            for (openvdb::Index z = 0; z < 8; ++z) {
                if (!out.isValueOn(n + z) || (row_.inside >> z & 1) == 0) continue;
                const double share = squeeze(row_.at[z]);
                if (share < hardly) continue;
                out.setValueOnly(n + z, static_cast<typename GridT::ValueType>(
                                            mean(out.offsetToGlobalCoord(n + z), share)));
                changed = true;
            }
        }
        return changed;
    }

private:
    /// Squeezing by less than this share is ignored.
    static constexpr double hardly = 1e-3;

    /// The share of length lost at a place, along the axis with the largest loss.
    double squeeze(const Vec3d& at) const {
        const auto image = derivative_.image(at);
        if (!image) return 0;
        double steepest = 1;
        for (const int axis : {0, 1, 2}) steepest = std::max(steepest, image->slope(axis, axis));
        return 1 - 1 / steepest;
    }

    /// Mean around a voxel. Along each axis, the kernel keeps long waves and, at full strength,
    /// removes waves of two voxels.
    /// @param share  of length lost at the place; from a half on, full strength
    double mean(const Coord& at, double share) const {
        const double part = std::min(2 * share, 1.0) / 16;
        const std::array weights{-part, 4 * part, 1 - 6 * part, 4 * part, -part};
        double sum = 0;
        for (int x = 0; x < 5; ++x)
            for (int y = 0; y < 5; ++y)
                for (int z = 0; z < 5; ++z)
                    sum += weights[static_cast<std::size_t>(x)] *
                           weights[static_cast<std::size_t>(y)] *
                           weights[static_cast<std::size_t>(z)] *
                           static_cast<double>(window_.get(at.offsetBy(x - 2, y - 2, z - 2)).value);
        return sum;
    }

    const CarveDerivative& derivative_;
    CarvedPlaces places_;
    CarvedPlaces::Row row_;
    BlockWindow<typename GridT::TreeType> window_;
};

template <class GridT>
openvdb::GridBase::ConstPtr smooth(const openvdb::GridBase::ConstPtr& base,
                                   const CarvedPlaces& places, const CarveDerivative& derivative) {
    const auto grid = openvdb::GridBase::grid<GridT>(base);
    return rewrite_blocks<GridT>(grid, places.voxels(derivative.range()), [&] {
        return block_worker<GridT, SqueezedSmooth<GridT>>(*grid, places, derivative);
    });
}

}  // namespace

openvdb::GridBase::ConstPtr squeezed_smooth(const openvdb::GridBase::ConstPtr& grid,
                                            const CarvedPlaces& places,
                                            const CarveDerivative& derivative) {
    if (grid->isType<openvdb::FloatGrid>())
        return smooth<openvdb::FloatGrid>(grid, places, derivative);
    return smooth<openvdb::DoubleGrid>(grid, places, derivative);
}

}  // namespace fluidcarve
