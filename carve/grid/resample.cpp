#include "carve/grid/resample.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "carve/field/collocate.h"
#include "carve/field/extent.h"
#include "carve/grid/each_grid.h"
#include "carve/volume/stored_form.h"

#include <fmt/format.h>
#include <openvdb/tools/GridTransformer.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <type_traits>

namespace fluidcarve {

namespace {

/// @throws Failure (input) if the new voxels in the space of the active ones take more than the
///   budget
void require_fits(const openvdb::GridBase& grid, const openvdb::math::Transform& transform,
                  double value_bytes, std::uint64_t budget) {
    const auto box = grid.evalActiveVoxelBoundingBox();
    if (box.empty()) return;
    require_near(grid.getName(), box);
    const openvdb::BBoxd shown(box.min().asVec3d(), box.max().asVec3d());
    voxels_around(grid.transform().indexToWorld(shown), transform,
                  fmt::format("grid '{}'", grid.getName()));
    const auto centre = shown.getCenter();
    const auto volume = [](const openvdb::math::Transform& of, const openvdb::Vec3d& at) {
        return std::abs(of.voxelSize(at).product());
    };
    const double share =
        volume(grid.transform(), centre) /
        volume(transform, transform.worldToIndex(grid.transform().indexToWorld(centre)));
    const double voxels = share * static_cast<double>(grid.activeVoxelCount()),
                 bytes = voxels * value_bytes;
    if (bytes <= static_cast<double>(budget)) return;
    throw Failure(fmt::format("grid '{}' would have {:.3g} voxels, which take {}, but --memory "
                              "allows {}: take larger voxels",
                              grid.getName(), voxels,
                              size_text(static_cast<std::uint64_t>(std::min(bytes, 1e18))),
                              size_text(budget)),
                  Failure::Kind::input);
}

/// The same grid, without its tree, on other voxels. A writer can still undo the reader's
/// placement.
template <class GridT>
typename GridT::Ptr moved_to(const GridT& grid, const openvdb::math::Transform& transform) {
    const auto out = grid.copyWithNewTree();
    if (const auto stored = stored_form_of(grid)) {
        StoredForm form;
        form.placement = stored->placement;
        form.placement.offset = openvdb::Vec3d(0);
        set_stored_form(*out, form);
    }
    out->setTransform(transform.copy());
    return out;
}

/// The grid with its values at the voxels' centres.
template <class GridT>
std::shared_ptr<const GridT> at_centres(const std::shared_ptr<const GridT>& grid) {
    if constexpr (std::is_same_v<GridT, VectorGrid>) return collocated(grid);
    else return grid;
}

/// OpenVDB can't sample masks, but it can sample boolean grids.
void sample_mask(const MaskGrid& mask, MaskGrid& out) {
    openvdb::BoolGrid from(
        std::make_shared<openvdb::BoolTree>(mask.tree(), false, true, openvdb::TopologyCopy())),
        to;
    from.setTransform(mask.transform().copy());
    to.setTransform(out.transform().copy());
    openvdb::tools::resampleToMatch<openvdb::tools::PointSampler>(from, to);
    out.setTree(std::make_shared<openvdb::MaskTree>(to.tree(), false, openvdb::TopologyCopy()));
}

}  // namespace

Volume resampled(const Volume& volume, const openvdb::math::Transform& transform,
                 std::uint64_t budget) {
    return each_grid(
        volume,
        [&]<class GridT>(const std::shared_ptr<const GridT>& given) -> openvdb::GridBase::ConstPtr {
            using Value = typename GridT::ValueType;
            using Element = typename openvdb::VecTraits<Value>::ElementType;
            if (given->transform() == transform || given->tree().empty()) return given;
            require_fits(*given, transform, sizeof(Value), budget);
            const auto grid = at_centres(given);
            const auto out = moved_to(*grid, transform);
            if (grid != given) out->setGridClass(openvdb::GRID_UNKNOWN);
            if constexpr (std::is_same_v<GridT, MaskGrid>) sample_mask(*grid, *out);
            else if constexpr (std::is_floating_point_v<Element>)
                openvdb::tools::resampleToMatch<openvdb::tools::BoxSampler>(*grid, *out);
            else openvdb::tools::resampleToMatch<openvdb::tools::PointSampler>(*grid, *out);
            return out;
        });
}

}  // namespace fluidcarve
