#include "nodes/rig/payload_type.h"

#include "nodes/rig/rig.h"

namespace fluidcarve {

void add_rig_payload(Registry& registry) {
    registry.add(payload_type<Rig>("rig", "The path that a lattice follows.", [](const Rig& rig) { return rig.points.size() * sizeof(openvdb::Vec3d); }));
}

}  // namespace fluidcarve
