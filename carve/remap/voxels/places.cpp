#include "carve/remap/voxels/places.h"

#include "carve/field/extent.h"

#include <cstddef>

namespace fluidcarve {

using openvdb::BBoxd;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

CarvedPlaces::CarvedPlaces(const Lattice& lattice, const std::array<int, 3>& extent,
                           const openvdb::math::Transform& transform,
                           const openvdb::math::Transform& cells)
    : extent_(extent),
      alignment_(align(lattice, cells)),
      mapping_(std::make_shared<const Mapping>(lattice, extent)),
      transform_(&transform),
      places_(*mapping_, transform) {
    if (alignment_ && !alignment_->one_to_one()) alignment_.reset();
}

CoordBBox CarvedPlaces::voxels(const BBoxd& range) const {
    return padded(voxels_around(mapping_->world_box(range), *transform_, "the lattice"), 2);
}

BBoxd CarvedPlaces::move_to(const Coord& block) {
    if (!alignment_) return places_.move_to(block);
    const auto a = alignment_->vertex(block), b = alignment_->vertex(block.offsetBy(7));
    return {Coord::minComponent(a, b).asVec3d(), Coord::maxComponent(a, b).asVec3d()};
}

void CarvedPlaces::locate(const Coord& first, const Vec3d& offset, Row& row) {
    if (!alignment_) {
        places_.locate(first, offset, found_);
        row.inside = found_.inside;
        for (std::size_t z = 0; z < 8; ++z) row.at[z] = found_.places[z].at;
        return;
    }
    row.inside = 0;
    for (int z = 0; z < 8; ++z) {
        const auto at = alignment_->vertex(first.offsetBy(0, 0, z));
        if (at.x() < 0 || at.x() >= extent_[0] || at.y() < 0 || at.y() >= extent_[1] ||
            at.z() < 0 || at.z() >= extent_[2])
            continue;
        row.at[static_cast<std::size_t>(z)] = at.asVec3d();
        row.inside |= 1u << z;
    }
}

}  // namespace fluidcarve
