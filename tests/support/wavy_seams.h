#pragma once

#include "carve/seam/carve_map.h"
#include "tests/support/seams_through.h"

#include <cmath>
#include <memory>

namespace fluidcarve::test {

/// Seams side by side around one entry, in waves across the lattice that close with it.
/// @param amplitude  entries; 0: straight
inline Seams wavy_seams(const Lattice& lattice, Axis axis, Seams::Kind kind, int entry, int count,
                        double amplitude) {
    auto out = no_seams(lattice, axis, kind);
    for (int n = 0; n < count; ++n) {
        std::vector<std::uint16_t> at;
        for (int k = 0; k < out.slices(); ++k)
            for (int lateral = 0; lateral < out.laterals(); ++lateral) {
                const double wave =
                    std::sin(0.25 * lateral) + std::sin(2 * M_PI * 3 * k / out.slices());
                at.push_back(
                    static_cast<std::uint16_t>(entry + (kind == Seams::Kind::insert ? n : 0) +
                                               static_cast<int>(std::lround(amplitude * wave))));
            }
        out.seams.push_back({at, 0.0});
    }
    return out;
}

inline CarveMap map_of(const Lattice& lattice, const std::vector<Seams>& sets, int frame = 1) {
    std::vector<Ref<Seams>> list;
    for (const auto& set : sets) list.push_back(std::make_shared<Seams>(set));
    return {lattice, list, frame, {}};
}

/// A box lattice turned about the z axis through the world's origin.
inline Lattice turned(Lattice box, double angle) {
    const auto turn = [&](const openvdb::Vec3d& p) {
        return openvdb::Vec3d(std::cos(angle) * p.x() - std::sin(angle) * p.y(),
                              std::sin(angle) * p.x() + std::cos(angle) * p.y(), p.z());
    };
    for (auto& plane : box.planes)
        for (auto* vector : {&plane.origin, &plane.u, &plane.v, &plane.w}) *vector = turn(*vector);
    box.hash = lattice_hash(box);
    return box;
}

}  // namespace fluidcarve::test
