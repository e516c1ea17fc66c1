#include "carve/lattice/block_places.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

namespace fluidcarve {

using openvdb::BBoxd;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

namespace {

/// Bit n is set if `first + n * step` is not below 0, for n = 0..7.
inline unsigned not_below(double first, double step) {
    const bool begins = first >= 0, ends = first + 7 * step >= 0;
    if (begins == ends) return begins ? 0xff : 0;
    const double zero = first / -step;
    const int below = static_cast<int>(zero);
    if (begins) return 0xff >> (7 - std::min(below, 6));
    return 0xff & (0xff << std::min(below < zero ? below + 1 : below, 7));
}

}  // namespace

BlockPlaces::BlockPlaces(const Mapping& mapping, const openvdb::math::Transform& transform)
    : mapping_(mapping), transform_(transform) {
    const auto* const slabs = mapping.slabs();
    if (!slabs || !transform.isLinear()) return;
    std::array<Vec3d, 3> voxel,
        unit;  // a voxel's edges in world units; the world's unit vectors in voxels
    for (int n = 0; n < 3; ++n) {
        Vec3d axis(0);
        axis[n] = 1;
        voxel[static_cast<std::size_t>(n)] =
            transform.indexToWorld(axis) - transform.indexToWorld(Vec3d(0));
        unit[static_cast<std::size_t>(n)] =
            transform.worldToIndex(axis) - transform.worldToIndex(Vec3d(0));
    }
    const auto gradient = [&](const Vec3d& of) {
        return Vec3d(of.dot(voxel[0]), of.dot(voxel[1]), of.dot(voxel[2]));
    };
    const auto in_index = [&](const Vec3d& step) {
        return step.x() * unit[0] + step.y() * unit[1] + step.z() * unit[2];
    };
    const auto tables = std::make_shared<std::vector<Table>>();
    for (int k = 0; k <= slabs->size(); ++k) {
        Table table{};
        table.side = gradient(slabs->divider(k).normal);
        if (k < slabs->size()) {
            const auto& vectors = (*slabs)[k].vectors();
            for (std::size_t n = 0; n < Slab::parts; ++n)
                for (int axis = 0; axis < 3; ++axis)
                    table.gradients[static_cast<std::size_t>(axis)][n] = gradient(vectors[n])[axis];
            table.u = in_index(vectors[3]);
            table.du = in_index(vectors[4]);
            table.v = in_index(vectors[5]);
            table.dv = in_index(vectors[6]);
        }
        tables->push_back(table);
    }
    for (int axis = 0; axis < 2; ++axis) {
        const auto even = [axis](const Table& table) {
            const auto& of = table.gradients[static_cast<std::size_t>(axis)];
            return table.side[axis] == 0 && of[0] == 0 && of[1] == 0 && of[2] == 0;
        };
        if (std::ranges::all_of(*tables, even)) even_ = axis;
    }
    tables_ = tables;
    by_tables_ = !slabs->closed_form();
}

BBoxd BlockPlaces::move_to(const Coord& block) {
    block_ = block;
    const auto first = block.asVec3d();
    const auto world = transform_.indexToWorld(BBoxd(first - Vec3d(0.5), first + Vec3d(7)));
    if (!tables_) return range_ = mapping_.range(world);

    const auto& slabs = *mapping_.slabs();
    range_ = slabs.candidates(world, slabs_);
    const auto origin = transform_.indexToWorld(first);
    interior_ = by_tables_ && slabs.inside(range_);
    for (auto& row : entered_) row.known = false;
    candidates_.clear();
    for (const int k : slabs_)
        candidates_.push_back({k, slabs.divider(k).side(origin), slabs.divider(k + 1).side(origin),
                               slabs[k].products(origin)});
    return range_;
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
        // Neighbouring slabs must agree at their common divider: its side is computed once.
        const unsigned low = last == candidate.slab ? above : side(candidate.slab, candidate.low);
        above = side(candidate.slab + 1, candidate.high);
        last = candidate.slab + 1;
        const unsigned hits = low & ~above;
        if (hits != 0 && !visit(candidate, hits)) return;
    }
}

Slab::Products BlockPlaces::at(const Vec3d& from, const Candidate& candidate) const {
    const auto& [along_x, along_y, along_z] =
        (*tables_)[static_cast<std::size_t>(candidate.slab)].gradients;
    Slab::Products out;
    for (std::size_t n = 0; n < out.size(); ++n)
        out[n] = candidate.products[n] + from.x() * along_x[n] + from.y() * along_y[n] +
                 from.z() * along_z[n];
    return out;
}

BlockPlaces::Entered& BlockPlaces::enter(const Vec3d& from) {
    const auto place =
        even_ ? 2 * static_cast<std::size_t>(2 * from[1 - *even_] + 1) + (from.z() < 0 ? 1 : 0) : 0;
    auto& row = entered_[place];
    if (!even_ || !row.known) find(from, row);
    return row;
}

void BlockPlaces::find(const Vec3d& from, Entered& row) const {
    const auto& slabs = *mapping_.slabs();
    row.known = true;
    row.levelled = false;
    row.once = row.twice = 0;
    CubicRow cubics;
    each_hit(from, [&](const Candidate& candidate, unsigned hits) {
        row.twice |= row.once & hits;
        hits &= ~row.once;
        row.once |= hits;
        if (hits == 0) return true;
        const auto first = at(from, candidate);
        const auto& along_z = (*tables_)[static_cast<std::size_t>(candidate.slab)].gradients[2];
        for (; hits != 0; hits &= hits - 1) {
            const auto z = static_cast<std::size_t>(std::countr_zero(hits));
            const auto along = static_cast<double>(z);
            row.in[z] = static_cast<std::size_t>(&candidate - candidates_.data());
            cubics.set(z, slabs[candidate.slab].cubic(first[0] + along * along_z[0],
                                                      first[1] + along * along_z[1],
                                                      first[2] + along * along_z[2]));
        }
        return true;
    });
    for (auto left = ~row.once & 0xff; left != 0; left &= left - 1)
        cubics.set(static_cast<std::size_t>(std::countr_zero(left)), {0, -1, 0, 0});
    cubics.solve();
    for (auto left = row.once; left != 0; left &= left - 1) {
        const auto z = static_cast<std::size_t>(std::countr_zero(left));
        const int slab = candidates_[row.in[z]].slab;
        const double from_c = slabs.from(slab), to_c = slabs.to(slab);
        row.c[z] =
            cubics.solved(z, from_c, to_c) ? cubics.c[z] : cubic_root(cubics.at(z), from_c, to_c);
    }
}

void BlockPlaces::find_levels(Entered& row) const {
    row.levelled = true;
    for (auto left = row.once; left != 0; left &= left - 1) {
        const auto z = static_cast<std::size_t>(std::countr_zero(left));
        const int slab = candidates_[row.in[z]].slab;
        const auto& table = (*tables_)[static_cast<std::size_t>(slab)];
        row.levels[z] = (*mapping_.slabs())[slab].level(row.c[z]);
        row.u[z] = table.u + row.c[z] * table.du;
        row.v[z] = table.v + row.c[z] * table.dv;
    }
}

bool BlockPlaces::settle(int slab, const Vec3d& solved, const Vec3d& u, const Vec3d& v,
                         std::size_t z, Row& row) const {
    const auto& slabs = *mapping_.slabs();
    Vec3d place;
    const auto holds = slabs.settle(slab, solved, place);
    if (holds == Slabs::Holds::no || (holds == Slabs::Holds::beyond && (row.inside >> z & 1) != 0))
        return false;
    if (slabs.polar()) {
        const auto away = slabs.polar()->direction(place.y());
        row.places[z] = {place, away.x() * u + away.y() * v, Vec3d(0)};
    } else {
        row.places[z] = {place, u, v};
    }
    row.inside |= 1u << z;
    return holds == Slabs::Holds::yes;
}

unsigned BlockPlaces::locate_lowest(const Vec3d& from, const Entered& entered, Row& row) const {
    const auto& slabs = *mapping_.slabs();
    unsigned open = entered.twice;
    Slab::Products at_first{};
    auto last = candidates_.size();
    for (auto left = entered.once; left != 0; left &= left - 1) {
        const auto z = static_cast<std::size_t>(std::countr_zero(left));
        const auto& candidate = candidates_[entered.in[z]];
        if (entered.in[z] != last) at_first = at(from, candidate);
        last = entered.in[z];
        const auto& along_z = (*tables_)[static_cast<std::size_t>(candidate.slab)].gradients[2];
        Slab::Products products;
        for (std::size_t n = 0; n < products.size(); ++n)
            products[n] = at_first[n] + static_cast<double>(z) * along_z[n];
        if (settle(candidate.slab, slabs[candidate.slab].at(products, entered.levels[z]),
                   entered.u[z], entered.v[z], z, row))
            open &= ~(1u << z);
    }
    return open;
}

void BlockPlaces::locate_higher(const Vec3d& from, const Entered& entered, unsigned open,
                                Row& row) const {
    const auto& slabs = *mapping_.slabs();
    each_hit(from, [&](const Candidate& candidate, unsigned hits) {
        for (hits &= open; hits != 0; hits &= hits - 1) {
            const auto z = static_cast<std::size_t>(std::countr_zero(hits));
            if (&candidate == &candidates_[entered.in[z]]) continue;
            const auto products = at(from + Vec3d(0, 0, static_cast<double>(z)), candidate);
            const auto& slab = slabs[candidate.slab];
            const double c = cubic_root(slab.cubic(products[0], products[1], products[2]),
                                        slabs.from(candidate.slab), slabs.to(candidate.slab));
            const auto& table = (*tables_)[static_cast<std::size_t>(candidate.slab)];
            if (settle(candidate.slab, slab.at(products, c), table.u + c * table.du,
                       table.v + c * table.dv, z, row))
                open &= ~(1u << z);
        }
        return open != 0;
    });
}

void BlockPlaces::locate(const Coord& first, const Vec3d& offset, Row& row) {
    row.inside = 0;
    if (!by_tables_) {
        for (int z = 0; z < 8; ++z)
            if (const auto at = mapping_.locate(
                    transform_.indexToWorld(first.offsetBy(0, 0, z).asVec3d() + offset))) {
                row.places[static_cast<std::size_t>(z)].at = *at;
                row.inside |= 1u << z;
            }
        return;
    }
    const auto from = (first - block_).asVec3d() + offset;
    auto& entered = enter(from);
    if (!entered.levelled) find_levels(entered);
    if (const auto open = locate_lowest(from, entered, row))
        locate_higher(from, entered, open, row);
}

unsigned BlockPlaces::shift(const Coord& first, const Vec3d& offset, const Vec3d& by,
                            Positions& out) {
    const auto& row = enter((first - block_).asVec3d() + offset);
    for (auto left = row.once; left != 0; left &= left - 1) {
        const int z = std::countr_zero(left);
        const auto n = static_cast<std::size_t>(z);
        const auto& table = (*tables_)[static_cast<std::size_t>(candidates_[row.in[n]].slab)];
        out.set(n, first.offsetBy(0, 0, z).asVec3d() + by.x() * (table.u + row.c[n] * table.du) +
                       by.y() * (table.v + row.c[n] * table.dv));
    }
    return row.once;
}

CoordBBox BlockPlaces::reach(const Vec3d& least, const Vec3d& most) const {
    const auto first = block_.asVec3d();
    BBoxd out;
    if (!by_tables_ || least.z() != 0 || most.z() != 0) {
        // This ignores the closed form's error, which is less than a vertex.
        out = transform_.worldToIndex(
            mapping_.world_box({range_.min() + least, range_.max() + most}));
        if (by_tables_) return {Coord::floor(out.min()), Coord::ceil(out.max())};
    }
    // Away from a rig means in any direction.
    auto low = least, high = most;
    if (mapping_.slabs() && mapping_.slabs()->polar()) {
        const double farthest = std::max(std::abs(least.x()), std::abs(most.x()));
        low = Vec3d(-farthest);
        high = Vec3d(farthest);
    }
    // Within a slab, steps lie between those at its two planes.
    for (const auto& candidate : candidates_)
        for (int n = 0; n < 8; ++n) {
            const auto& table = (*tables_)[static_cast<std::size_t>(candidate.slab)];
            const double c = n >> 2, by_u = n & 1 ? high.x() : low.x(),
                         by_v = n & 2 ? high.y() : low.y();
            const auto shift = by_u * (table.u + c * table.du) + by_v * (table.v + c * table.dv);
            out.expand(first + shift);
            out.expand(first + Vec3d(7) + shift);
        }
    return {Coord::floor(out.min()), Coord::ceil(out.max())};
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

    // These voxels lie between the planes of several slabs, but perhaps in the cells of only one.
    const auto& slabs = *mapping_.slabs();
    unsigned held = 0, shared = 0;
    each_hit(from, [&](const Candidate& candidate, unsigned hits) {
        for (hits &= twice; hits != 0; hits &= hits - 1) {
            const int z = std::countr_zero(hits);
            const auto solved =
                slabs[candidate.slab].solve(at(from + Vec3d(0, 0, z), candidate),
                                            slabs.from(candidate.slab), slabs.to(candidate.slab));
            Vec3d place;
            if (slabs.settle(candidate.slab, solved, place) == Slabs::Holds::no) continue;
            if ((held >> z & 1) == 0) lowest[static_cast<std::size_t>(z)] = candidate.slab;
            else shared |= 1u << z;
            held |= 1u << z;
        }
        return true;
    });
    return shared;
}

}  // namespace fluidcarve
