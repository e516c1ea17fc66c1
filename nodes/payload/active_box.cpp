#include "nodes/payload/active_box.h"

#include "carve/base/failure.h"
#include "carve/field/extent.h"
#include "carve/field/same_transform.h"
#include "carve/stream/transform_bytes.h"

#include <fmt/format.h>

namespace fluidcarve {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

namespace {

/// Largest distance from a voxel that rounding explains, voxels.
constexpr double rounding = 2e-3;

}  // namespace

CoordBBox voxels_among(const openvdb::math::Transform& first, const CoordBBox& voxels,
                       const openvdb::math::Transform& transform, const std::string& name,
                       int frame) {
    if (first == transform) return voxels;
    CoordBBox out;
    for (int n = 0; n < 8; ++n) {
        const auto corner = [&](int axis) -> double {
            return (n >> axis & 1) != 0 ? voxels.max()[axis] : voxels.min()[axis];
        };
        const auto at =
            first.worldToIndex(transform.indexToWorld(Vec3d(corner(0), corner(1), corner(2))));
        if (!voxel_at(at))
            throw Failure(
                fmt::format("grid '{}' has {} in frame {}, too far from the others for one lattice",
                            name, place_text(transform), frame));
        out.expand(Coord::floor(at + Vec3d(rounding)));
        out.expand(Coord::ceil(at - Vec3d(rounding)));
    }
    return out;
}

PayloadType active_box_type() {
    return payload_type<ActiveBox>(
        "active_box",
        "The box around a grid's active voxels in one frame; lattice.box keeps one per frame.",
        [](const ActiveBox&) { return sizeof(ActiveBox); },
        {1,
         [](const ActiveBox& box, std::ostream& stream) {
             BinaryWriter to(stream);
             to.text(box.name);
             write_transform(*box.transform, to);
             for (const auto& corner : {box.voxels.min(), box.voxels.max()})
                 to.bytes(corner.data(), 3 * sizeof(*corner.data()));
         },
         [](std::istream& stream) {
             BinaryReader from(stream);
             auto out = std::make_shared<ActiveBox>();
             out->name = from.text();
             out->transform = read_transform(from);
             for (auto* const corner : {&out->voxels.min(), &out->voxels.max()})
                 from.bytes(corner->data(), 3 * sizeof(*corner->data()));
             return out;
         }});
}

}  // namespace fluidcarve
