#include "nodes/payload/add_payloads.h"

#include "carve/seam/seams.h"
#include "carve/stream/binary.h"
#include "carve/stream/packed.h"
#include "formats/seam_file/seam_checksum.h"

#include <algorithm>
#include <numeric>
#include <span>

namespace fluidcarve {
namespace {

/// The differences of a seam's entries from column to column: most are 0, so they take little
/// space.
std::vector<std::uint16_t> differences_of(std::span<const std::uint16_t> entries) {
    std::vector<std::uint16_t> out(entries.size());
    std::adjacent_difference(
        entries.begin(), entries.end(), out.begin(),
        [](int entry, int before) { return static_cast<std::uint16_t>(entry - before); });
    return out;
}

std::vector<std::uint16_t> entries_of(std::vector<std::uint16_t> differences) {
    std::partial_sum(differences.begin(), differences.end(), differences.begin(),
                     [](int sum, int next) { return static_cast<std::uint16_t>(sum + next); });
    return differences;
}

void write_list(const std::vector<Seams::Seam>& seams, BinaryWriter& out) {
    out.value(std::uint64_t{seams.size()});
    for (const auto& seam : seams) {
        write_packed(differences_of(seam.at.all()), out);
        out.value(seam.energy);
        out.optional(seam.lower_bound);
    }
}

void write_warp(const Warp& warp, BinaryWriter& out) {
    out.value(warp.factor());
    out.value(warp.scale());
    out.value(warp.linear());
    out.value(std::uint64_t{warp.frames()});
    for (std::size_t t = 0; t < warp.frames(); ++t) out.list(warp.values(t));
}

/// @param seams  give the shape, the frames and whether the lattice is closed
Warp read_warp(BinaryReader& in, const Seams& seams) {
    const int factor = in.value<int>();
    in.require((factor == 1 || factor == 2 || factor == 4) && seams.before() >= 1);
    const double scale = in.value<double>();
    const bool linear = in.value<bool>();
    const auto frames = in.value<std::uint64_t>();
    in.require(frames >= 1 && (frames == 1 || frames == seams.frames.size()));
    auto values = in.list<float>();
    std::uint64_t points = 1;
    for (const auto n : Warp::points_of(seams.warp_vertices(), seams.warp_rings(), factor))
        in.require(!__builtin_mul_overflow(points, static_cast<std::uint64_t>(n), &points));
    in.require(values.size() == points);
    Warp out(seams.warp_vertices(), seams.warp_rings(), factor, frames);
    for (std::size_t t = 0; t < frames; ++t) {
        if (t > 0) values = in.list<float>();
        in.require(values.size() == points);
        std::ranges::copy(values, out.values(t).begin());
    }
    out.find_bounds();
    out.set_scale(scale);
    out.set_linear(linear);
    in.require(out.scaled(out.bounds().slope).least > -1);
    return out;
}

/// @param columns  entries of each seam
std::vector<Seams::Seam> read_list(BinaryReader& in, std::uint64_t columns) {
    std::vector<Seams::Seam> out;
    for (auto left = in.value<std::uint64_t>(); left > 0; --left) {
        auto& seam = out.emplace_back();
        seam.at = entries_of(read_packed(columns, in));
        seam.energy = in.value<double>();
        seam.lower_bound = in.optional<double>();
    }
    return out;
}

std::uint64_t bytes_of_seams(const Seams& seams) {
    const auto warp = seams.warp ? seams.warp->frames() * seams.warp->values(0).size_bytes() : 0;
    return warp +
           (seams.seams.size() + seams.pairs.size()) * seams.columns() * sizeof(std::uint16_t);
}

void write_all(const Seams& seams, std::ostream& to) {
    BinaryWriter out(to);
    out.value(seams.axis);
    out.value(seams.kind);
    out.value(seams.closed);
    out.value(seams.around);
    out.value(seams.shape);
    out.list(seams.frames);
    out.text(seams.lattice);
    out.text(seams.lattice_hash);
    out.optional(seams.window);
    out.optional(seams.pair_window);
    out.optional(seams.pair_below);
    out.value(seams.anchor.at);
    out.value(seams.anchor.vertex);
    out.value(seams.thickness);
    write_list(seams.seams, out);
    write_list(seams.pairs, out);
    out.value(seams.warp.has_value());
    if (seams.warp) write_warp(*seams.warp, out);
}

Ref<Seams> read_all(std::istream& from) {
    BinaryReader in(from);
    const auto out = std::make_shared<Seams>();
    out->axis = in.value_up_to(Axis::t);
    out->kind = in.value_up_to(Seams::Kind::insert);
    out->closed = in.value<bool>();
    out->around = in.value<bool>();
    out->shape = in.value<std::array<int, 3>>();
    out->frames = in.list<int>();
    std::uint64_t columns = out->layers();
    in.require(out->shape[0] >= 1);
    for (const auto n : {lateral_dimension(out->axis), slice_dimension(out->axis)})
        in.require(
            out->shape[n] >= 1 &&
            !__builtin_mul_overflow(columns, static_cast<std::uint64_t>(out->shape[n]), &columns));
    out->lattice = in.text();
    out->lattice_hash = in.text();
    out->window = in.optional<Window>();
    out->pair_window = in.optional<Window>();
    out->pair_below = in.optional<Window>();
    out->anchor.at = in.value_up_to(Anchor::At::vertex);
    out->anchor.vertex = in.value<int>();
    out->thickness = in.value<int>();
    in.require(out->thickness >= 1 && out->thickness <= out->before());
    out->seams = read_list(in, columns);
    out->pairs = read_list(in, columns);
    if (in.value<bool>()) {
        in.require(!out->in_time());
        out->warp = read_warp(in, *out);
    }
    out->find_shifts();
    return out;
}

}  // namespace

void add_seams_payload(Registry& registry) {
    auto type = payload_type<Seams>("seams",
                                    "Seams through a lattice over all frames, in order; or a warp, "
                                    "which moves content smoothly instead.",
                                    &bytes_of_seams, {6, &write_all, &read_all});
    type.checksum = [](const Payload& seams) { return seam_checksum(*seams.as<Seams>()); };
    registry.add(std::move(type));
}

}  // namespace fluidcarve
