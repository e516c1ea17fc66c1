#pragma once

#include "carve/seam/seams.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace fluidcarve::test {

/// A set through a lattice that has no seams yet.
inline Seams no_seams(const Lattice& lattice, Axis axis = Axis::u,
                      Seams::Kind kind = Seams::Kind::remove, std::vector<int> frames = {1}) {
    Seams out;
    out.axis = axis;
    out.kind = kind;
    out.closed = lattice.closed;
    out.around = lattice.around;
    out.shape = lattice.shape;
    out.frames = std::move(frames);
    out.lattice = lattice.description;
    out.lattice_hash = lattice.hash;
    return out;
}

/// One seam of a set, at the same entry in all columns of all frames.
inline Seams::Seam straight_seam(const Seams& set, int entry) {
    return {std::vector<std::uint16_t>(set.columns(), static_cast<std::uint16_t>(entry)), 0.0};
}

inline Seams straight_seams(const Lattice& lattice, Axis axis, Seams::Kind kind,
                            const std::vector<int>& entries, std::vector<int> frames = {1}) {
    auto out = no_seams(lattice, axis, kind, std::move(frames));
    for (const int entry : entries) out.seams.push_back(straight_seam(out, entry));
    return out;
}

}  // namespace fluidcarve::test
