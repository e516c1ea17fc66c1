#include "nodes/seam/energy_slab.h"

#include "graph/problem.h"
#include "nodes/field/leaf_cell.h"
#include "nodes/lattice/alignment.h"
#include "nodes/lattice/mapping.h"
#include "nodes/seam/energy_code.h"

#include <fmt/format.h>
#include <openvdb/tools/Interpolation.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace fluidcarve {

namespace {

using openvdb::Vec3d;

/// The vertex of entry `i` in column `(lateral, k)`.
std::array<int, 3> vertex(Axis axis, int entry, int lateral, int k) { return axis == Axis::u ? std::array{entry, lateral, k} : std::array{lateral, entry, k}; }

/// Readers go along one column at a time, whose vertices stand on a line at equal distances.
class ByIndex {
public:
    ByIndex(const openvdb::FloatGrid& grid, const Alignment& alignment, Axis axis)
        : values_(grid.getConstAccessor()), alignment_(alignment), step_(alignment.step[static_cast<std::size_t>(axis)]) {}
    void move_to(const std::array<int, 3>& first) { first_ = alignment_.voxel(first[0], first[1], first[2]); }
    float operator()(int entry) { return values_.getValue(first_ + openvdb::Coord(entry * step_.x(), entry * step_.y(), entry * step_.z())); }

private:
    openvdb::FloatGrid::ConstAccessor values_;
    const Alignment& alignment_;
    const openvdb::Coord step_;
    openvdb::Coord first_;
};

class Trilinear {
public:
    Trilinear(const openvdb::FloatGrid& grid, const Lattice& lattice, Axis axis)
        : transform_(grid.transform()), linear_(transform_.isLinear()), values_(grid.getConstAccessor()), lattice_(lattice), axis_(axis) {}
    void move_to(const std::array<int, 3>& first) {
        const Vec3d at(first[0], first[1], first[2]);
        auto next = at;
        next[static_cast<int>(axis_)] += 1;
        const auto position = [&](const Vec3d& vertex) {
            const auto world = lattice_.position(vertex);
            return linear_ ? transform_.worldToIndex(world) : world;
        };
        first_ = position(at);
        step_ = position(next) - first_;
    }
    float operator()(int entry) {
        const auto at = first_ + entry * step_;
        return sample(snapped(linear_ ? at : transform_.worldToIndex(at)));
    }

private:
    float sample(const Vec3d& q) {
        using Sampler = openvdb::tools::BoxSampler;
        const auto low = voxel_below(q);
        float cell[2][2][2];
        const auto* const leaf = in_one_leaf(low) ? values_.probeConstLeaf(low) : nullptr;
        if (leaf) read_cell(*leaf, low, cell);
        else Sampler::getValues(cell, values_, low);
        return Sampler::trilinearInterpolation(cell, q - low.asVec3d());
    }

    const openvdb::math::Transform& transform_;
    const bool linear_;
    openvdb::FloatGrid::ConstAccessor values_;
    const Lattice& lattice_;
    const Axis axis_;
    Vec3d first_, step_;  ///< of the column: index units, or world units if the transform is not linear
};

template <class MakeReader>
void fill(const Lattice& lattice, Axis axis, std::span<std::uint16_t> slab, MakeReader&& make_reader) {
    const int entries = lattice.shape[axis == Axis::u ? 0 : 1], laterals = lattice.shape[axis == Axis::u ? 1 : 0];
    tbb::parallel_for(tbb::blocked_range<int>(0, lattice.shape[2] * laterals, 16), [&](const tbb::blocked_range<int>& range) {
        auto read = make_reader();
        auto out = slab.begin() + static_cast<std::ptrdiff_t>(range.begin()) * entries;
        for (int column = range.begin(); column < range.end(); ++column) {
            read.move_to(vertex(axis, 0, column % laterals, column / laterals));
            for (int entry = 0; entry < entries; ++entry) *out++ = encode_energy(read(entry));
        }
    });
    // Searched serially, so that the place named is always the first.
    const auto bad = std::find(slab.begin(), slab.end(), invalid_energy_code);
    if (bad == slab.end()) return;
    const auto place = bad - slab.begin();
    const int entry = static_cast<int>(place % entries), lateral = static_cast<int>(place / entries % laterals);
    const auto at = vertex(axis, entry, lateral, static_cast<int>(place / entries / laterals));
    const auto world = lattice.position(Vec3d(at[0], at[1], at[2]));
    auto read = make_reader();
    read.move_to(vertex(axis, 0, lateral, at[2]));
    throw Failure(fmt::format("the energy is {} at ({:g}, {:g}, {:g}), vertex ({}, {}, {}); seams need energies from 0 to {:.3g}", read(entry), world.x(),
                              world.y(), world.z(), at[0], at[1], at[2], decode_energy(highest_energy_code)));
}

openvdb::BBoxd world_box(const Lattice& lattice) {
    openvdb::BBoxd out;
    for (int k = 0; k < lattice.shape[2]; ++k)
        for (int n = 0; n < 4; ++n) out.expand(lattice.position(Vec3d(n & 1 ? lattice.shape[0] - 1 : 0, n & 2 ? lattice.shape[1] - 1 : 0, k)));
    return out;
}

}  // namespace

void sample_energy(const openvdb::FloatGrid& energy, const Lattice& lattice, Axis axis, std::span<std::uint16_t> slab) {
    if (const auto alignment = align(lattice, energy.transform())) fill(lattice, axis, slab, [&] { return ByIndex(energy, *alignment, axis); });
    else fill(lattice, axis, slab, [&] { return Trilinear(energy, lattice, axis); });
}

bool meets_active_voxels(const openvdb::GridBase& grid, const Lattice& lattice) {
    const auto box = grid.evalActiveVoxelBoundingBox();
    if (box.empty()) return false;
    const auto data = grid.transform().indexToWorld(openvdb::BBoxd(box.min().asVec3d() - Vec3d(1), box.max().asVec3d() + Vec3d(1)));
    return data.hasOverlap(world_box(lattice));
}

}  // namespace fluidcarve
