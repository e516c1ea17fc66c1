#include "nodes/payload/add_payloads.h"

#include "carve/rig/rig.h"
#include "carve/stream/binary.h"

namespace fluidcarve {
namespace {

void put_rig(const Rig& rig, std::ostream& to) {
    BinaryWriter out(to);
    out.list(rig.points);
    out.value(rig.closed);
    out.value(rig.up);
    out.optional(rig.oval);
}

Ref<Rig> get_rig(std::istream& from) {
    BinaryReader in(from);
    const auto out = std::make_shared<Rig>();
    out->points = in.list<openvdb::Vec3d>();
    out->closed = in.value<bool>();
    out->up = in.value<openvdb::Vec3d>();
    out->oval = in.optional<Rig::Oval>();
    return out;
}

}  // namespace

void add_rig_payload(Registry& registry) {
    registry.add(
        payload_type<Rig>("rig", "The path that a lattice follows.",
                          [](const Rig& rig) { return rig.points.size() * sizeof(openvdb::Vec3d); },
                          {1, &put_rig, &get_rig}));
}

}  // namespace fluidcarve
