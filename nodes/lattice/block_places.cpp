#include "nodes/lattice/block_places.h"

#include <bit>

namespace fluidcarve {

using openvdb::BBoxd;
using openvdb::Coord;
using openvdb::Vec3d;

namespace {

/// Which of eight values on a line, from `first` on, are not below 0.
unsigned not_below(double first, double step) {
    const bool begins = first >= 0, ends = first + 7 * step >= 0;
    if (begins == ends) return begins ? 0xff : 0;
    unsigned out = 0;
    for (int z = 0; z < 8; ++z) out |= static_cast<unsigned>(first + z * step >= 0) << z;
    return out;
}

}  // namespace

BlockPlaces::BlockPlaces(const Mapping& mapping, const openvdb::math::Transform& transform) : mapping_(mapping), transform_(transform) {
    const auto* const slabs = mapping.slabs();
    if (!slabs || !transform.isLinear()) return;
    std::array<Vec3d, 3> voxel, unit;  // a voxel's edges in world units, and the world's in voxels
    for (int n = 0; n < 3; ++n) {
        Vec3d axis(0);
        axis[n] = 1;
        voxel[static_cast<std::size_t>(n)] = transform.indexToWorld(axis) - transform.indexToWorld(Vec3d(0));
        unit[static_cast<std::size_t>(n)] = transform.worldToIndex(axis) - transform.worldToIndex(Vec3d(0));
    }
    const auto gradient = [&](const Vec3d& of) { return Vec3d(of.dot(voxel[0]), of.dot(voxel[1]), of.dot(voxel[2])); };
    const auto in_index = [&](const Vec3d& step) { return step.x() * unit[0] + step.y() * unit[1] + step.z() * unit[2]; };
    const auto tables = std::make_shared<std::vector<Table>>();
    for (int k = 0; k <= slabs->size(); ++k) {
        Table table{};
        table.side = gradient(slabs->divider(k).normal);
        if (k < slabs->size()) {
            const auto& vectors = (*slabs)[k].vectors();
            for (std::size_t n = 0; n < Slab::parts; ++n)
                for (int axis = 0; axis < 3; ++axis) table.gradients[static_cast<std::size_t>(axis)][n] = gradient(vectors[n])[axis];
            table.u = in_index(vectors[3]);
            table.du = in_index(vectors[4]);
            table.v = in_index(vectors[5]);
            table.dv = in_index(vectors[6]);
        }
        tables->push_back(table);
    }
    tables_ = tables;
    by_tables_ = !slabs->closed_form();
}

BBoxd BlockPlaces::move_to(const Coord& block) {
    block_ = block;
    const auto first = block.asVec3d();
    const auto world = transform_.indexToWorld(BBoxd(first - Vec3d(0.5), first + Vec3d(7)));
    if (!tables_) return mapping_.range(world);

    const auto& slabs = *mapping_.slabs();
    const auto range = slabs.candidates(world, slabs_);
    const auto origin = transform_.indexToWorld(first);
    candidates_.clear();
    for (const int k : slabs_) candidates_.push_back({k, slabs.divider(k).side(origin), slabs.divider(k + 1).side(origin), slabs[k].products(origin)});
    return range;
}

template <class Visit>
void BlockPlaces::each_hit(const Vec3d& from, Visit&& visit) const {
    int last = -1;
    unsigned above = 0;
    for (const auto& candidate : candidates_) {
        const auto side = [&](int divider, double at_first) {
            const auto& gradient = (*tables_)[static_cast<std::size_t>(divider)].side;
            return not_below(at_first + gradient.dot(from), gradient.z());
        };
        // Both slabs beside a divider must judge alike.
        const unsigned low = last == candidate.slab ? above : side(candidate.slab, candidate.low);
        above = side(candidate.slab + 1, candidate.high);
        last = candidate.slab + 1;
        const unsigned hits = low & ~above;
        if (hits != 0 && !visit(candidate, hits)) return;
    }
}

Slab::Products BlockPlaces::at(const Vec3d& from, const Candidate& candidate) const {
    const auto& [along_x, along_y, along_z] = (*tables_)[static_cast<std::size_t>(candidate.slab)].gradients;
    Slab::Products out;
    for (std::size_t n = 0; n < out.size(); ++n) out[n] = candidate.products[n] + from.x() * along_x[n] + from.y() * along_y[n] + from.z() * along_z[n];
    return out;
}

Vec3d BlockPlaces::solve(const Candidate& candidate, const Slab::Products& first, int z) const {
    const auto& along_z = (*tables_)[static_cast<std::size_t>(candidate.slab)].gradients[2];
    Slab::Products products;
    for (std::size_t n = 0; n < products.size(); ++n) products[n] = first[n] + z * along_z[n];
    const auto& slabs = *mapping_.slabs();
    return slabs[candidate.slab].solve(products, slabs.from(candidate.slab), slabs.to(candidate.slab));
}

void BlockPlaces::locate(const Coord& first, const Vec3d& offset, Row& row) const {
    row.inside = 0;
    if (!by_tables_) {
        for (int z = 0; z < 8; ++z)
            if (const auto at = mapping_.locate(transform_.indexToWorld(first.offsetBy(0, 0, z).asVec3d() + offset))) {
                row.places[static_cast<std::size_t>(z)].at = *at;
                row.inside |= 1u << z;
            }
        return;
    }
    const auto from = (first - block_).asVec3d() + offset;
    unsigned open = 0xff;
    each_hit(from, [&](const Candidate& candidate, unsigned hits) {
        if ((hits & open) == 0) return true;
        const auto& table = (*tables_)[static_cast<std::size_t>(candidate.slab)];
        const auto products = at(from, candidate);
        for (hits &= open; hits != 0; hits &= hits - 1) {
            const int z = std::countr_zero(hits);
            const auto solved = solve(candidate, products, z);
            Vec3d place;
            const auto holds = mapping_.slabs()->settle(candidate.slab, solved, place);
            if (holds == Slabs::Holds::no || (holds == Slabs::Holds::beyond && (row.inside >> z & 1) != 0)) continue;
            row.places[static_cast<std::size_t>(z)] = {place, table.u + solved.z() * table.du, table.v + solved.z() * table.dv};
            row.inside |= 1u << z;
            if (holds == Slabs::Holds::yes) open &= ~(1u << z);
        }
        return open != 0;
    });
}

unsigned BlockPlaces::locate_shared(const Coord& first, std::array<int, 8>& lowest) const {
    const auto from = (first - block_).asVec3d();
    unsigned once = 0, twice = 0;
    if (!tables_) return 0;
    each_hit(from, [&](const Candidate&, unsigned hits) {
        twice |= once & hits;
        once |= hits;
        return true;
    });
    if (twice == 0) return 0;

    // Between the planes of several slabs, but perhaps beside the cells of all but one.
    unsigned held = 0, shared = 0;
    each_hit(from, [&](const Candidate& candidate, unsigned hits) {
        for (hits &= twice; hits != 0; hits &= hits - 1) {
            const int z = std::countr_zero(hits);
            Vec3d place;
            if (mapping_.slabs()->settle(candidate.slab, solve(candidate, at(from, candidate), z), place) == Slabs::Holds::no) continue;
            if ((held >> z & 1) == 0) lowest[static_cast<std::size_t>(z)] = candidate.slab;
            else shared |= 1u << z;
            held |= 1u << z;
        }
        return true;
    });
    return shared;
}

}  // namespace fluidcarve
