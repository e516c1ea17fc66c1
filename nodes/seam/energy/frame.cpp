#include "nodes/seam/energy/frame.h"

#include "graph/text/problem.h"
#include "graph/text/words.h"
#include "nodes/field/dense.h"
#include "nodes/io/transform_bytes.h"
#include "nodes/seam/energy/code.h"
#include "nodes/seam/energy/marks.h"

#include <fmt/format.h>
#include <openvdb/io/Compression.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>

namespace fluidcarve {

namespace {

/// Highest compression ratio that is possible. A file that claims more is damaged.
constexpr std::size_t most_packed = 4096;

/// Writes codes compressed: neighbouring codes are alike, and most of them 0.
void write_codes(const std::vector<std::uint16_t>& codes, BinaryWriter& to) {
    std::ostringstream packed;
    openvdb::io::bloscToStream(packed, reinterpret_cast<const char*>(codes.data()), sizeof(std::uint16_t), codes.size());
    to.text(packed.view());
}

std::vector<std::uint16_t> read_codes(std::size_t count, BinaryReader& from) {
    const auto packed = from.text();
    // The library trusts the stated size: the number of bytes that follow, below 0 if they are not compressed.
    std::int64_t size = 0;
    BinaryReader::require(packed.size() >= sizeof size);
    std::memcpy(&size, packed.data(), sizeof size);
    const auto there = static_cast<std::int64_t>(packed.size() - sizeof size);
    const auto bytes = count * sizeof(std::uint16_t);
    BinaryReader::require(size == there ? bytes / most_packed <= packed.size() : size == -there && bytes == static_cast<std::size_t>(there));
    std::vector<std::uint16_t> out(count);
    std::istringstream in(packed);
    try {
        openvdb::io::bloscFromStream(in, reinterpret_cast<char*>(out.data()), bytes);
    } catch (const openvdb::Exception&) {
        BinaryReader::require(false);
    }
    return out;
}

void write(const FrameEnergy& frame, BinaryWriter& to) {
    write_codes(frame.energy, to);
    to.optional(frame.protect);
    to.optional(frame.attract);
    to.optional(frame.protect_missed);
    to.optional(frame.attract_missed);
    write_transform(*frame.transform, to);
    to.value(frame.field_transform != nullptr);
    if (frame.field_transform) {
        write_codes(frame.field, to);
        write_transform(*frame.field_transform, to);
    }
    to.value(frame.active.has_value());
    if (frame.active)
        for (const auto& corner : {frame.active->min(), frame.active->max()}) to.bytes(corner.asPointer(), 3 * sizeof(double));
    to.value(frame.content.voxels);
    to.value(frame.content.inside);
}

void read(FrameEnergy& out, BinaryReader& from) {
    std::size_t vertices = 1;
    for (const int size : out.lattice->shape) {
        BinaryReader::require(size >= 1);
        vertices *= static_cast<std::size_t>(size);
    }
    out.energy = read_codes(vertices, from);
    out.protect = from.optional<std::size_t>();
    out.attract = from.optional<std::size_t>();
    out.protect_missed = from.optional<MissedRange>();
    out.attract_missed = from.optional<MissedRange>();
    out.transform = read_transform(from);
    if (from.value<bool>()) {
        out.field = read_codes(vertices, from);
        out.field_transform = read_transform(from);
    }
    if (from.value<bool>()) {
        openvdb::Vec3d low, high;
        for (auto* const corner : {&low, &high}) from.bytes(corner->asPointer(), 3 * sizeof(double));
        out.active.emplace(low, high);
    }
    out.content.voxels = from.value<std::uint64_t>();
    out.content.inside = from.value<double>();
}

}  // namespace

void require_frame_fits(const FrameGrids& grids, const Lattice& lattice, std::uint64_t budget) {
    const double bytes_per_vertex = sizeof(std::uint16_t) * (grids.field ? 2.0 : 1.0);
    const auto bytes = [&](double spacing) {
        double out = bytes_per_vertex;
        for (const int vertices : lattice.shape) out *= std::floor((vertices - 1) * lattice.spacing / spacing + 1e-9) + 1;
        return out;
    };
    const double wanted = bytes(lattice.spacing);
    if (grid_fits(wanted, budget)) return;
    const auto size = grids.energy.voxelSize();
    const double voxel = std::max({size.x(), size.y(), size.z()});
    double fits = std::max(voxel, lattice.spacing);
    constexpr double wider = 1.25;
    while (!grid_fits(bytes(fits), budget)) fits *= wider;
    throw Failure(
        fmt::format("at a 'spacing' of {:.6g} the lattice has {} vertices, which take {} in each frame, but --memory allows {}; the voxels of "
                    "`energy` are {:.6g} wide: a 'spacing' of {:.6g} fits",
                    lattice.spacing, fmt::join(lattice.shape, " x "), size_text(static_cast<std::uint64_t>(wanted)), size_text(budget), voxel, fits));
}

FrameEnergy sample_frame(const FrameGrids& grids, const Ref<Lattice>& lattice, Axis axis, Measure measure) {
    FrameEnergy out;
    out.lattice = lattice;
    const auto size = [&](std::size_t dimension) { return static_cast<std::size_t>(lattice->shape[dimension]); };
    out.energy.resize(size(0) * size(1) * size(2));
    sample_energy(grids.energy, *lattice, axis, out.energy, measure);
    out.content = content_in(grids.energy, *lattice);
    // What counts by some voxels may miss the few that a vertex sees.
    const auto empty = encode_energy(grids.energy.background());
    if (out.content.inside == 0 && std::ranges::any_of(out.energy, [&](std::uint16_t code) { return code != empty; })) out.content.inside = 1;
    if (grids.attract) out.attract = mark_vertices(*grids.attract, *lattice, axis, attracted_code, out.energy);
    if (grids.protect) out.protect = mark_vertices(*grids.protect, *lattice, axis, protected_code, out.energy);
    if (grids.attract) out.attract_missed = missed_range(*grids.attract);
    if (grids.protect) out.protect_missed = missed_range(*grids.protect);
    out.transform = grids.energy.transform().copy();
    if (const auto box = grids.energy.evalActiveVoxelBoundingBox(); !box.empty())
        out.active = grids.energy.transform().indexToWorld(openvdb::BBoxd(box.min().asVec3d(), box.max().asVec3d()));
    if (grids.field) {
        out.field.resize(out.energy.size());
        sample_field(*grids.field, *lattice, axis, out.field);
        out.field_transform = grids.field->transform().copy();
    }
    return out;
}

void add_frame_energy_payload(Registry& registry) {
    const auto& lattice = registry.payload(typeid(Lattice));
    Filed<FrameEnergy> filed;
    filed.version = 3 + lattice.version;  // raising either version raises the sum
    filed.write = [lattice](const FrameEnergy& frame, std::ostream& stream) {
        lattice.write(Payload(frame.lattice), stream);
        BinaryWriter to(stream);
        write(frame, to);
    };
    filed.read = [lattice](std::istream& stream) {
        auto out = std::make_shared<FrameEnergy>();
        out->lattice = lattice.read(stream).as<Lattice>();
        BinaryReader from(stream);
        read(*out, from);
        return out;
    };
    registry.add(payload_type<FrameEnergy>(
        "frame_energy", "The energy at a lattice's vertices in one frame; solvers keep one per frame.",
        [](const FrameEnergy& frame) { return (frame.energy.size() + frame.field.size()) * sizeof(std::uint16_t); }, std::move(filed)));
}

}  // namespace fluidcarve
