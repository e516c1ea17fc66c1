#include "nodes/payload/active_box.h"

#include "carve/stream/transform_bytes.h"

#include <array>

namespace fluidcarve {

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
