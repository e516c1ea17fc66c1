#pragma once

#include <openvdb/Types.h>
#include <openvdb/math/Coord.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

/// The values of a box of cells. Places are in cells, cell centres at whole numbers; beyond the box
/// the nearest cell counts.
template <class T>
struct Cells {
    openvdb::Coord size;
    std::vector<T> values;

    Cells() = default;
    explicit Cells(const openvdb::Coord& cells, const T& value = T(0))
        : size(cells),
          values(static_cast<std::size_t>(cells.x()) * static_cast<std::size_t>(cells.y()) *
                     static_cast<std::size_t>(cells.z()),
                 value) {}

    std::size_t place(const openvdb::Coord& cell) const {
        return (static_cast<std::size_t>(cell.x()) * static_cast<std::size_t>(size.y()) +
                static_cast<std::size_t>(cell.y())) *
                   static_cast<std::size_t>(size.z()) +
               static_cast<std::size_t>(cell.z());
    }
    T& operator[](const openvdb::Coord& cell) { return values[place(cell)]; }
    const T& operator[](const openvdb::Coord& cell) const { return values[place(cell)]; }

    /// Each cell has what `value` gives for its place. Many at once.
    template <class Value>
    static Cells filled(const openvdb::Coord& cells, const Value& value) {
        Cells out(cells);
        tbb::parallel_for(0, cells.x(), [&](int x) {
            for (int y = 0; y < cells.y(); ++y)
                for (int z = 0; z < cells.z(); ++z) out[{x, y, z}] = value(openvdb::Coord(x, y, z));
        });
        return out;
    }

    /// The value between the cells' centres.
    T linear(const openvdb::Vec3f& at) const {
        return weighed<2>(
            at,
            [](float x) {
                return std::array{1 - x, x};
            },
            0.0f);
    }
    /// The same, smooth: quadratic B-splines. It does not pass through the cells' values.
    T smooth(const openvdb::Vec3f& at) const {
        return weighed<3>(
            at,
            [](float x) {
                return std::array{0.5f * (1 - x) * (1 - x), 0.5f + x * (1 - x), 0.5f * x * x};
            },
            -0.5f);
    }

private:
    /// @param weights  of the cells along an axis, by the place between the first two, 0 to 1
    /// @param shift    from a place to the first cell of its support
    template <std::size_t support, class Weights>
    T weighed(const openvdb::Vec3f& at, const Weights& weights, float shift) const {
        std::array<std::array<std::size_t, support>, 3> offset;
        std::array<std::array<float, support>, 3> weight;
        const std::array<std::size_t, 3> stride{
            static_cast<std::size_t>(size.y()) * static_cast<std::size_t>(size.z()),
            static_cast<std::size_t>(size.z()), 1};
        for (int axis = 0; axis < 3; ++axis) {
            const float inside =
                std::clamp(at[axis], 0.0f, static_cast<float>(size[axis] - 1)) + shift;
            const int first = static_cast<int>(inside + 1) - 1;
            weight[axis] = weights(inside - static_cast<float>(first));
            for (int n = 0; n < static_cast<int>(support); ++n)
                offset[axis][n] =
                    static_cast<std::size_t>(std::clamp(first + n, 0, size[axis] - 1)) *
                    stride[axis];
        }
        T out(0);
        for (std::size_t x = 0; x < support; ++x)
            for (std::size_t y = 0; y < support; ++y) {
                T row(0);
                for (std::size_t z = 0; z < support; ++z)
                    row += weight[2][z] * values[offset[0][x] + offset[1][y] + offset[2][z]];
                out += weight[0][x] * weight[1][y] * row;
            }
        return out;
    }
};
