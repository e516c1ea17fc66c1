#include "nodes/seam/energy_slab.h"

#include "graph/problem.h"
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

struct ByIndex {
    ByIndex(const openvdb::FloatGrid& grid, const Alignment& alignment) : values(grid.getConstAccessor()), alignment(alignment) {}
    float operator()(const std::array<int, 3>& at) { return values.getValue(alignment.voxel(at[0], at[1], at[2])); }
    openvdb::FloatGrid::ConstAccessor values;
    const Alignment& alignment;
};

struct Trilinear {
    Trilinear(const openvdb::FloatGrid& grid, const Lattice& lattice) : grid(grid), values(grid.getConstAccessor()), lattice(lattice) {}
    float operator()(const std::array<int, 3>& at) {
        return openvdb::tools::BoxSampler::sample(values, snapped(grid.worldToIndex(lattice.position(Vec3d(at[0], at[1], at[2])))));
    }
    const openvdb::FloatGrid& grid;
    openvdb::FloatGrid::ConstAccessor values;
    const Lattice& lattice;
};

template <class MakeReader>
void fill(const Lattice& lattice, Axis axis, std::span<std::uint16_t> slab, MakeReader&& make_reader) {
    const int entries = lattice.shape[axis == Axis::u ? 0 : 1], laterals = lattice.shape[axis == Axis::u ? 1 : 0];
    tbb::parallel_for(tbb::blocked_range<int>(0, lattice.shape[2]), [&](const tbb::blocked_range<int>& range) {
        auto read = make_reader();
        auto out = slab.begin() + static_cast<std::ptrdiff_t>(range.begin()) * laterals * entries;
        for (int k = range.begin(); k < range.end(); ++k)
            for (int lateral = 0; lateral < laterals; ++lateral)
                for (int entry = 0; entry < entries; ++entry) *out++ = encode_energy(read(vertex(axis, entry, lateral, k)));
    });
    // Searched serially, so that the place named is always the first.
    const auto bad = std::find(slab.begin(), slab.end(), invalid_energy_code);
    if (bad == slab.end()) return;
    const auto place = bad - slab.begin();
    const auto at = vertex(axis, static_cast<int>(place % entries), static_cast<int>(place / entries % laterals), static_cast<int>(place / entries / laterals));
    const auto world = lattice.position(Vec3d(at[0], at[1], at[2]));
    throw Failure(fmt::format("the energy is {} at ({:g}, {:g}, {:g}), vertex ({}, {}, {}); seams need energies from 0 to {:.3g}", make_reader()(at), world.x(),
                              world.y(), world.z(), at[0], at[1], at[2], decode_energy(highest_energy_code)));
}

openvdb::BBoxd world_box(const Lattice& lattice) {
    openvdb::BBoxd out;
    for (int n = 0; n < 8; ++n)
        out.expand(lattice.position(Vec3d(n & 1 ? lattice.shape[0] - 1 : 0, n & 2 ? lattice.shape[1] - 1 : 0, n & 4 ? lattice.shape[2] - 1 : 0)));
    return out;
}

}  // namespace

void sample_energy(const openvdb::FloatGrid& energy, const Lattice& lattice, Axis axis, std::span<std::uint16_t> slab) {
    if (const auto alignment = align(lattice, energy.transform())) fill(lattice, axis, slab, [&] { return ByIndex(energy, *alignment); });
    else fill(lattice, axis, slab, [&] { return Trilinear(energy, lattice); });
}

bool meets_active_voxels(const openvdb::GridBase& grid, const Lattice& lattice) {
    const auto box = grid.evalActiveVoxelBoundingBox();
    if (box.empty()) return false;
    const auto data = grid.transform().indexToWorld(openvdb::BBoxd(box.min().asVec3d() - Vec3d(1), box.max().asVec3d() + Vec3d(1)));
    return data.hasOverlap(world_box(lattice));
}

}  // namespace fluidcarve
