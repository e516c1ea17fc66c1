#include "carve/mesh/edges.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace fluidcarve {

std::size_t boundary_edges(const Mesh& mesh) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sides;
    sides.reserve(mesh.corners.size());
    for (std::size_t n = 0; n < mesh.faces(); ++n) {
        const auto face = mesh.face(n);
        for (std::size_t c = 0; c < face.size(); ++c)
            sides.emplace_back(std::minmax(face[c], face[(c + 1) % face.size()]));
    }
    std::ranges::sort(sides);
    std::size_t out = 0;
    for (auto side = sides.begin(); side != sides.end();) {
        const auto next = std::upper_bound(side, sides.end(), *side);
        out += side->first != side->second && (next - side) % 2 != 0;
        side = next;
    }
    return out;
}

}  // namespace fluidcarve
