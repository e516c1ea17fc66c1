#pragma once

#include "tests/support/seams_through.h"

#include <functional>

namespace fluidcarve::test {

/// How far the content of a vertex moves, vertices.
/// @param t  index of the frame
using Shift = std::function<double(int entry, int lateral, int k, int t)>;

/// A warp through a lattice, with the values of a function at its points.
/// @param still  one frame holds for all
inline Seams warped(const Lattice& lattice, const Shift& shift, Axis axis = Axis::u,
                    std::vector<int> frames = {1}, int factor = 1, bool still = false) {
    auto out = no_seams(lattice, axis, Seams::Kind::remove, std::move(frames));
    Warp warp(out.warp_vertices(), out.warp_rings(), factor, still ? 1 : out.frames.size());
    const auto& points = warp.points();
    for (std::size_t t = 0; t < warp.frames(); ++t) {
        auto value = warp.values(t).begin();
        for (int k = 0; k < points[2]; ++k)
            for (int lateral = 0; lateral < points[1]; ++lateral)
                for (int u = 0; u < points[0]; ++u)
                    *value++ =
                        static_cast<float>(shift(warp.vertex_of(0, u), warp.vertex_of(1, lateral),
                                                 warp.vertex_of(2, k), static_cast<int>(t)));
    }
    warp.find_bounds();
    out.warp = std::move(warp);
    return out;
}

/// Scales a lattice evenly: its last vertex moves by so many vertices, its first one stays.
inline Shift evenly(const Lattice& lattice, double by, Axis axis = Axis::u) {
    return [by, last = lattice.shape[dimension(axis)] - 1](int entry, int, int, int) {
        return by * entry / last;
    };
}

}  // namespace fluidcarve::test
