#include "nodes/payload/add_payloads.h"

#include "carve/solver/costs/frame_energy.h"
#include "carve/solver/costs/half.h"
#include "carve/stream/binary.h"
#include "carve/stream/packed.h"
#include "carve/stream/transform_bytes.h"

namespace fluidcarve {

namespace {

void put_frame(const FrameEnergy& frame, BinaryWriter& to) {
    to.value(frame.finest);
    write_packed(frame.energy, to);
    to.optional(frame.protect);
    to.optional(frame.attract);
    to.optional(frame.protect_missed);
    to.optional(frame.attract_missed);
    write_transform(*frame.transform, to);
    to.value(frame.field_transform != nullptr);
    if (frame.field_transform) {
        write_packed(frame.field, to);
        write_transform(*frame.field_transform, to);
    }
    to.value(frame.active.has_value());
    if (frame.active)
        for (const auto& corner : {frame.active->min(), frame.active->max()})
            to.bytes(corner.asPointer(), 3 * sizeof(double));
    to.value(frame.content.voxels);
    to.value(frame.content.inside);
    to.optional(frame.width);
}

void get_frame(FrameEnergy& out, BinaryReader& from) {
    out.finest = from.value<int>();
    BinaryReader::require(out.finest == 1 || out.finest == 2);
    std::size_t vertices = 1;
    for (const int size : gathered_shape(out.lattice->shape, out.finest)) {
        BinaryReader::require(size >= 1);
        vertices *= static_cast<std::size_t>(size);
    }
    out.energy = read_packed(vertices, from);
    out.protect = from.optional<std::size_t>();
    out.attract = from.optional<std::size_t>();
    out.protect_missed = from.optional<MissedRange>();
    out.attract_missed = from.optional<MissedRange>();
    out.transform = read_transform(from);
    if (from.value<bool>()) {
        out.field = read_packed(vertices, from);
        out.field_transform = read_transform(from);
    }
    if (from.value<bool>()) {
        openvdb::Vec3d low, high;
        for (auto* const corner : {&low, &high})
            from.bytes(corner->asPointer(), 3 * sizeof(double));
        out.active.emplace(low, high);
    }
    out.content.voxels = from.value<std::uint64_t>();
    out.content.inside = from.value<double>();
    out.width = from.optional<int>();
}

}  // namespace

void add_frame_energy_payload(Registry& registry) {
    const auto& lattice = registry.payload(typeid(Lattice));
    Filed<FrameEnergy> filed;
    filed.version = 5 + lattice.version;  // raising either version raises the sum
    filed.write = [lattice](const FrameEnergy& frame, std::ostream& stream) {
        lattice.write(Payload(frame.lattice), stream);
        BinaryWriter to(stream);
        put_frame(frame, to);
    };
    filed.read = [lattice](std::istream& stream) {
        auto out = std::make_shared<FrameEnergy>();
        out->lattice = lattice.read(stream).as<Lattice>();
        BinaryReader from(stream);
        get_frame(*out, from);
        return out;
    };
    registry.add(payload_type<FrameEnergy>(
        "frame_energy",
        "The energy at a lattice's vertices in one frame; solvers keep one per frame.",
        [](const FrameEnergy& frame) {
            return (frame.energy.size() + frame.field.size()) * sizeof(std::uint16_t);
        },
        std::move(filed)));
}

}  // namespace fluidcarve
