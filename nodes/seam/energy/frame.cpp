#include "nodes/seam/energy/frame.h"

#include "graph/text/problem.h"
#include "graph/text/words.h"
#include "nodes/field/dense.h"
#include "nodes/field/extent.h"
#include "nodes/io/packed.h"
#include "nodes/io/transform_bytes.h"
#include "nodes/seam/energy/code.h"
#include "nodes/seam/energy/half.h"
#include "nodes/seam/energy/marks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fluidcarve {

namespace {

void write(const FrameEnergy& frame, BinaryWriter& to) {
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
        for (const auto& corner : {frame.active->min(), frame.active->max()}) to.bytes(corner.asPointer(), 3 * sizeof(double));
    to.value(frame.content.voxels);
    to.value(frame.content.inside);
}

void read(FrameEnergy& out, BinaryReader& from) {
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
        for (auto* const corner : {&low, &high}) from.bytes(corner->asPointer(), 3 * sizeof(double));
        out.active.emplace(low, high);
    }
    out.content.voxels = from.value<std::uint64_t>();
    out.content.inside = from.value<double>();
}

std::size_t plane_size(const std::array<int, 3>& shape) { return static_cast<std::size_t>(shape[0]) * static_cast<std::size_t>(shape[1]); }

/// Samples some planes at a time, and halves them.
/// @param sample  fills the codes of planes: `sample(planes, energy, field)`
template <class Sample>
void sample_halves(const Lattice& lattice, Axis axis, const Sample& sample, FrameEnergy& out) {
    constexpr std::size_t vertices_at_once = std::size_t{1} << 22;
    const auto size = plane_size(lattice.shape), coarse_size = plane_size(gathered_shape(lattice.shape, 2));
    const int at_once = 2 * static_cast<int>(std::max<std::size_t>(vertices_at_once / (2 * size), 1));
    std::vector<std::uint16_t> energy, field;
    for (int first = 0; first < lattice.shape[2]; first += at_once) {
        const Planes planes{first, std::min(at_once, lattice.shape[2] - first)};
        const auto count = static_cast<std::size_t>(planes.count);
        energy.resize(size * count);
        field.resize(out.field.empty() ? 0 : energy.size());
        sample(planes, energy, field);
        const ColumnShape shape{static_cast<std::size_t>(lattice.shape[dimension(axis)]), static_cast<std::size_t>(lattice.shape[lateral_dimension(axis)]),
                                count};
        const auto halves = [&](std::vector<std::uint16_t>& codes) {
            return std::span(codes).subspan(coarse_size * static_cast<std::size_t>(first / 2), coarse_size * halved(count));
        };
        halve_energy(energy, shape, halves(out.energy));
        if (!field.empty()) halve_field(field, shape, halves(out.field));
    }
}

}  // namespace

void require_frame_fits(const FrameGrids& grids, const Lattice& lattice, std::uint64_t budget, int finest) {
    const double bytes_per_vertex = sizeof(std::uint16_t) * (grids.field ? 2.0 : 1.0) / (finest * finest * finest);
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

FrameEnergy sample_frame(const FrameGrids& grids, const Ref<Lattice>& lattice, Axis axis, Measure measure, int finest) {
    FrameEnergy out;
    out.lattice = lattice;
    out.finest = finest;
    if (grids.attract) out.attract = 0;
    if (grids.protect) out.protect = 0;
    // What counts by some voxels may miss the few that a vertex sees.
    const auto empty = encode_energy(grids.energy.background());
    bool sees_content = false;
    const auto sample = [&](const Planes& planes, std::span<std::uint16_t> energy, std::span<std::uint16_t> field) {
        sample_energy(grids.energy, *lattice, axis, energy, measure, planes);
        sees_content = sees_content || std::ranges::any_of(energy, [&](std::uint16_t code) { return code != empty; });
        if (grids.attract) *out.attract += mark_vertices(*grids.attract, *lattice, axis, attracted_code, energy, planes);
        if (grids.protect) *out.protect += mark_vertices(*grids.protect, *lattice, axis, protected_code, energy, planes);
        if (grids.field) sample_field(*grids.field, *lattice, axis, field, planes);
    };
    const auto shape = gathered_shape(lattice->shape, finest);
    out.energy.resize(plane_size(shape) * static_cast<std::size_t>(shape[2]));
    if (grids.field) out.field.resize(out.energy.size());
    if (finest == 1) sample({0, shape[2]}, out.energy, out.field);
    else sample_halves(*lattice, axis, sample, out);
    out.content = content_in(grids.energy, *lattice);
    if (out.content.inside == 0 && sees_content) out.content.inside = 1;
    if (grids.attract) out.attract_missed = missed_range(*grids.attract);
    if (grids.protect) out.protect_missed = missed_range(*grids.protect);
    out.transform = grids.energy.transform().copy();
    if (const auto box = active_box(grids.energy); !box.empty())
        out.active = grids.energy.transform().indexToWorld(openvdb::BBoxd(box.min().asVec3d(), box.max().asVec3d()));
    if (grids.field) out.field_transform = grids.field->transform().copy();
    return out;
}

void add_frame_energy_payload(Registry& registry) {
    const auto& lattice = registry.payload(typeid(Lattice));
    Filed<FrameEnergy> filed;
    filed.version = 4 + lattice.version;  // raising either version raises the sum
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
