#include "carve/remap/geometry/mesh.h"

#include "carve/base/each_in_parallel.h"
#include "carve/lattice/mapping.h"
#include "carve/seam/carve_inverse.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace fluidcarve {
namespace {

using openvdb::Vec3d;

/// Shortest displacement that is visible, vertices.
constexpr double least_way = 0.5;

/// How a mesh vertex moves.
struct VertexMove {
    bool inside = false;
    Vec3d by{0};  ///< displacement along u, v and w, vertices
    double length() const {
        return std::max({std::abs(by.x()), std::abs(by.y()), std::abs(by.z())});
    }
};

std::string share_text(double share) {
    return share >= 0.1 ? "more than 10 %" : share >= 0.01 ? "1 to 10 %" : "less than 1 %";
}

}  // namespace

CarvedMesh carve_mesh(const Mesh& mesh, const Lattice& lattice, const CarveMap& map) {
    CarvedMesh out{mesh, {}, {}};
    const Mapping mapping(map.extended(lattice));
    std::vector<VertexMove> ways(mesh.points.size());
    each_in_parallel(ways.size(), 1024, [&](std::size_t n) {
        const auto from = mapping.locate(mesh.points[n]);
        if (!from) return;
        const auto to = carved_coordinates(map, *from);
        ways[n] = {true, to - *from};
        if (to != *from) out.mesh.points[n] += mapping.position(to) - mapping.position(*from);
    });

    std::size_t stretched = 0, torn = 0;
    for (std::size_t n = 0; n < mesh.faces(); ++n) {
        const auto face = mesh.face(n);
        double farthest = 0;  ///< of its edges across the rim
        for (std::size_t c = 0; c < face.size(); ++c) {
            const auto a = face[c], b = face[(c + 1) % face.size()];
            if (ways[a].inside != ways[b].inside)
                farthest = std::max(farthest, ways[ways[a].inside ? a : b].length());
            const double length = (mesh.points[a] - mesh.points[b]).length() / lattice.spacing;
            if (!ways[a].inside || !ways[b].inside || length <= 2 ||
                VertexMove{true, ways[a].by - ways[b].by}.length() < least_way)
                continue;
            ++stretched;
            out.stretched.worst = std::max(out.stretched.worst, length);
        }
        if (farthest < least_way) continue;
        ++torn;
        out.torn.worst = std::max(out.torn.worst, farthest);
    }
    if (stretched > 0)
        out.stretched.share =
            static_cast<double>(stretched) / static_cast<double>(mesh.corners.size());
    if (torn > 0) out.torn.share = static_cast<double>(torn) / static_cast<double>(mesh.faces());
    return out;
}

std::vector<std::string> warnings_of(const CarvedMesh& carved) {
    std::vector<std::string> out;
    if (const auto& strain = carved.stretched; strain.share > 0)
        out.push_back(
            fmt::format("{} of the edges cross a seam and are longer than two vertices of the "
                        "lattice, the longest {:.0f}: they stay straight where space "
                        "bends; subdivide the mesh there",
                        share_text(strain.share), std::ceil(strain.worst)));
    if (const auto& strain = carved.torn; strain.share > 0)
        out.push_back(
            fmt::format("{} of the faces cross a rim of the lattice, and only the part inside the "
                        "lattice moves, by {:.0f} vertices at most: they are stretched or folded "
                        "there; make the lattice larger, or set `rim: fade`",
                        share_text(strain.share), std::ceil(strain.worst)));
    return out;
}

}  // namespace fluidcarve
