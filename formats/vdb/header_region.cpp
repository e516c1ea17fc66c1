#include "formats/vdb/header_region.h"

namespace fluidcarve {

using openvdb::Vec3d;

void HeaderRegion::add(const VdbHeader::Entry& grid, const Placement& placement) {
    const auto count =
        grid.metadata.getMetadata<openvdb::Int64Metadata>(openvdb::GridBase::META_FILE_VOXEL_COUNT);
    const auto low =
        grid.metadata.getMetadata<openvdb::Vec3IMetadata>(openvdb::GridBase::META_FILE_BBOX_MIN);
    const auto high =
        grid.metadata.getMetadata<openvdb::Vec3IMetadata>(openvdb::GridBase::META_FILE_BBOX_MAX);
    known_ = known_ && grid.transform && grid.transform->isLinear() && count &&
             (count->value() == 0 || (low && high));
    if (!known_ || count->value() == 0) return;
    // Voxels reach half their width beyond their centres, and derived values a little further.
    const openvdb::BBoxd voxels(Vec3d(low->value()) - Vec3d(1), Vec3d(high->value()) + Vec3d(1));
    box_.expand(placed(*grid.transform, placement)->indexToWorld(voxels));
}

std::optional<Region> HeaderRegion::region() const {
    if (!known_) return std::nullopt;
    if (box_.empty()) return Region{};
    const auto &low = box_.min(), &high = box_.max();
    return Region{{Region::Box{{low.x(), low.y(), low.z()}, {high.x(), high.y(), high.z()}}}, {}};
}

}  // namespace fluidcarve
