#pragma once

#include "carve/remap/grid.h"
#include "tests/support/seams_through.h"

#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <random>
#include <type_traits>
#include <vector>

namespace fluidcarve::test {

/// A box of voxels, dense, each with value and state.
template <class T>
struct Dense {
    struct Voxel {
        T value;
        bool on;
    };
    openvdb::CoordBBox box;
    std::vector<Voxel> voxels;

    template <class Grid>
    Dense(const Grid& grid, const openvdb::CoordBBox& box) : box(box) {
        auto values = grid.getConstAccessor();
        for (auto at = box.begin(); at; ++at)
            voxels.push_back({values.getValue(*at), values.isValueOn(*at)});
    }
    Voxel& at(const openvdb::Coord& c) {
        const auto from = c - box.min();
        const auto size = box.dim();
        return voxels.at(
            static_cast<std::size_t>((from.x() * size.y() + from.y()) * size.z() + from.z()));
    }
};

/// Whether two boxes have the same states, and values of the same bytes.
template <class T>
bool same(const Dense<T>& a, const Dense<T>& b) {
    for (std::size_t n = 0; n < a.voxels.size(); ++n)
        if (a.voxels[n].on != b.voxels[n].on ||
            std::memcmp(&a.voxels[n].value, &b.voxels[n].value, sizeof(T)) != 0)
            return false;
    return true;
}

/// Where lattice vertices are voxels: vertex (i, j, k) at origin + i step[0] + j step[1] + k
/// step[2].
struct Layout {
    openvdb::Coord origin{0, 0, 0};
    std::array<openvdb::Coord, 3> step{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    openvdb::Coord operator()(const std::array<int, 3>& at) const {
        auto out = origin;
        for (std::size_t n = 0; n < 3; ++n)
            for (int c = 0; c < 3; ++c) out[c] += at[n] * step[n][c];
        return out;
    }
};

/// What an insertion puts between two voxels of a grid of this type.
template <class Grid>
typename Dense<typename Grid::ValueType>::Voxel mean_voxel(
    const typename Dense<typename Grid::ValueType>::Voxel& a,
    const typename Dense<typename Grid::ValueType>::Voxel& b) {
    using T = typename Grid::ValueType;
    using Element = typename openvdb::VecTraits<T>::ElementType;
    if constexpr (std::is_same_v<typename Grid::BuildType, openvdb::ValueMask>) return a;
    else if constexpr (std::is_floating_point_v<Element>)
        return {T((a.value + b.value) / Element(2)), a.on || b.on};
    else return {a.value, a.on || b.on};
}

/// Classical seam carving, one seam after the other, column by column, straight from its
/// definition: the reference for everything that is cleverer. Only the first `count` seams of a
/// set.
template <class T, class Mean>
void carve(Dense<T>& dense, const Layout& layout, const Seams& seams, std::size_t t,
           std::size_t count, const T& background, const Mean& mean) {
    using Voxel = typename Dense<T>::Voxel;
    const int size = seams.before();
    for (int k = 0; k < seams.slices(); ++k)
        for (int lateral = 0; lateral < seams.laterals(); ++lateral) {
            const auto vertex = [&](int entry) {
                return layout(vertex_of(seams.axis, entry, lateral, k));
            };
            const auto column = t * seams.columns_per_frame() +
                                static_cast<std::size_t>(lateral + seams.laterals() * k);
            std::vector<Voxel> before, after;
            for (int i = 0; i < size; ++i) before.push_back(dense.at(vertex(i)));
            // The two windows of pairs know nothing of each other.
            std::vector<int> left, doubled;
            for (int i = 0; i < size; ++i) left.push_back(i);
            const auto take = [&](const std::vector<Seams::Seam>& window, Seams::Kind kind) {
                for (std::size_t n = 0; n < std::min(count, window.size()); ++n) {
                    const int entry = window[n].at[column];
                    if (kind == Seams::Kind::remove) left.erase(left.begin() + entry);
                    else doubled.push_back(entry);
                }
            };
            take(seams.seams, seams.kind);
            take(seams.pairs, opposite(seams.kind));
            for (int i = 0; i < size; ++i) {
                const auto own = before[static_cast<std::size_t>(i)];
                if (std::ranges::count(left, i)) after.push_back(own);
                for (auto n = std::ranges::count(doubled, i); n > 0; --n)
                    after.push_back(mean(own, before.at(static_cast<std::size_t>(i + 1))));
            }
            after.resize(std::max(before.size(), after.size()), Voxel{background, false});
            for (std::size_t i = 0; i < after.size(); ++i)
                dense.at(vertex(static_cast<int>(i))) = after[i];
        }
}

/// 0 to n - 1.
inline int below(std::mt19937& random, int n) {
    return static_cast<int>(random() % static_cast<unsigned>(n));
}

/// A set of arbitrary seams, not even feasible: carving does not ask for it.
inline Seams random_seams(std::mt19937& random, const Lattice& lattice,
                          const std::array<int, 3>& shape, Axis axis, Seams::Kind kind, int count,
                          std::vector<int> frames) {
    auto out = no_seams(lattice, axis, kind, std::move(frames));
    out.shape = shape;
    const auto columns = out.columns_per_frame() * out.frames.size();
    out.seams.resize(static_cast<std::size_t>(count));
    for (auto& seam : out.seams) seam.at = std::vector<std::uint16_t>(columns);
    for (std::size_t c = 0; c < columns; ++c) {
        std::vector<int> free;
        for (int i = 0; i + 1 < out.before(); ++i) free.push_back(i);
        std::ranges::shuffle(free, random);
        for (int n = 0; n < count; ++n)
            out.seams[static_cast<std::size_t>(n)].at.all()[c] = static_cast<std::uint16_t>(
                kind == Seams::Kind::insert
                    ? free.at(static_cast<std::size_t>(n))
                    : static_cast<int>(random() % static_cast<unsigned>(out.before() - n)));
    }
    return out;
}

/// The same in pairs: the first window of each column below a random vertex, the pair's from it on.
/// @param count  at most a third of the vertices along the axis
inline Seams random_pairs(std::mt19937& random, const Lattice& lattice,
                          const std::array<int, 3>& shape, Axis axis, Seams::Kind kind, int count,
                          std::vector<int> frames) {
    auto out = random_seams(random, lattice, shape, axis, kind, 0, std::move(frames));
    const auto columns = out.columns_per_frame() * out.frames.size();
    for (auto* const window : {&out.seams, &out.pairs})
        for (int n = 0; n < count; ++n)
            window->push_back({std::vector<std::uint16_t>(columns), 0.0});
    for (std::size_t c = 0; c < columns; ++c) {
        const auto fill = [&](std::vector<Seams::Seam>& window, Seams::Kind kind, int first,
                              int last) {
            std::vector<int> free;
            for (int i = first; i <= last; ++i) free.push_back(i);
            std::ranges::shuffle(free, random);
            for (int n = 0; n < count; ++n)
                window[static_cast<std::size_t>(n)].at.all()[c] = static_cast<std::uint16_t>(
                    kind == Seams::Kind::insert
                        ? free.at(static_cast<std::size_t>(n))
                        : first + static_cast<int>(random() %
                                                   static_cast<unsigned>(last - first + 1 - n)));
        };
        const int room = out.before() - 1 - 2 * count,
                  border = count + static_cast<int>(random() % static_cast<unsigned>(room + 1));
        fill(out.seams, kind, 0, border - 1);
        fill(out.pairs, opposite(kind), border, out.before() - 2);
    }
    return out;
}

/// Sets of arbitrary seams along arbitrary axes, each found in the vertices that those before it
/// leave. The shape of the vertices that all leave is `sets.back()->shape_after()`.
/// @param most  seams of one set at most; no more than a third of the vertices along any axis
inline std::vector<Ref<Seams>> random_sets(std::mt19937& random, const Lattice& lattice, int length,
                                           int most, const std::vector<int>& frames) {
    std::vector<Ref<Seams>> out;
    auto shape = lattice.shape;
    for (int step = 0; step < length; ++step) {
        const auto axis = static_cast<Axis>(random() % 3);
        const auto kind = random() % 2 == 0 ? Seams::Kind::remove : Seams::Kind::insert;
        const auto make = random() % 2 == 0 ? random_pairs : random_seams;
        out.push_back(std::make_shared<Seams>(
            make(random, lattice, shape, axis, kind, below(random, most + 1), frames)));
        shape = out.back()->shape_after(out.back()->seams.size());
    }
    return out;
}

/// A grid with a value at each voxel of a box, all active.
inline FloatGrid::Ptr dense_grid(const openvdb::CoordBBox& box,
                                 const openvdb::math::Transform::Ptr& transform,
                                 const std::function<float(const openvdb::Coord&)>& value) {
    const auto out = FloatGrid::create();
    out->setTransform(transform);
    auto values = out->getAccessor();
    for (auto at = box.begin(); at; ++at) values.setValueOn(*at, value(*at));
    return out;
}

/// What carve_grid() makes of a grid of this type.
template <class Grid>
typename Grid::ConstPtr carved(const typename Grid::ConstPtr& grid, const Lattice& lattice,
                               const CarveMap& map,
                               Interpolation interpolation = Interpolation::linear) {
    return openvdb::GridBase::grid<Grid>(carve_grid(grid, lattice, map, interpolation));
}

}  // namespace fluidcarve::test
