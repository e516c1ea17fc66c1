#include "nodes/remap/tears.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace fluidcarve {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;

/// Vertices of a rim that are looked at, about.
constexpr double most_vertices_of_rim = 4096;

/// A face of the carved box of vertices.
struct Rim {
    int axis;
    bool high;
};

/// Where the content of a carved vertex comes from; nothing if a removal frees it.
std::optional<Coord> origin_of(const CarveMap& map, Coord vertex) {
    for (auto step = map.steps().rbegin(); step != map.steps().rend(); ++step) {
        const int axis = step->axis(), entry = vertex[axis], lateral = vertex[step->lateral_axis()];
        if (!step->has_column(lateral, vertex.z()) || entry >= step->reach()) continue;
        if (entry >= step->after()) return std::nullopt;
        vertex[axis] += step->displacement(entry, lateral, vertex.z()) / 2;
    }
    return vertex;
}

/// Whether a displacement ends at a rim with a jump. Towards the low end of its own axis it has none.
bool jumps(const CarveMap& map, const Rim& rim, const Coord& by) {
    for (int axis = 0; axis < 2; ++axis)
        if (by[axis] != 0 && (axis == rim.axis ? rim.high : !map.fades())) return true;
    return false;
}

template <class GridT>
double share_of(const GridT& grid, const Lattice& lattice, const CarveMap& map, const std::array<int, 3>& carved, const Rim& rim) {
    const int a = rim.axis == 0 ? 1 : 0, b = rim.axis == 2 ? 1 : 2;
    const auto size = [&](int axis) { return carved[static_cast<std::size_t>(axis)]; };
    const int stride = static_cast<int>(std::ceil(std::sqrt(std::max(1.0, static_cast<double>(size(a)) * size(b) / most_vertices_of_rim))));
    auto values = grid.getConstAccessor();
    const auto holds = [&](const Vec3d& at) {
        typename GridT::ValueType value;
        return values.probeValue(Coord::round(grid.worldToIndex(lattice.position(at))), value) && value != grid.background();
    };
    // A vertex away, but at least a voxel.
    const double beyond = std::max(1.0, grid.voxelSize().x() / lattice.spacing);
    int all = 0, torn = 0;
    Coord vertex;
    vertex[rim.axis] = rim.high ? size(rim.axis) - 1 : 0;
    for (vertex[a] = 0; vertex[a] < size(a); vertex[a] += stride)
        for (vertex[b] = 0; vertex[b] < size(b); vertex[b] += stride) {
            ++all;
            const auto from = origin_of(map, vertex);
            if (!from || !jumps(map, rim, *from - vertex)) continue;
            const auto inside = from->asVec3d();
            auto outside = inside;
            outside[rim.axis] = rim.high ? lattice.shape[static_cast<std::size_t>(rim.axis)] - 1 + beyond : -beyond;
            torn += holds(inside) && holds(outside);
        }
    return static_cast<double>(torn) / all;
}

}  // namespace

std::vector<Tear> find_tears(const Volume& volume, const Lattice& lattice, const CarveMap& map) {
    auto carved = lattice.shape;
    for (const auto& step : map.steps()) carved[static_cast<std::size_t>(step.axis())] = step.after();
    const auto is_density = [](const auto& grid) { return grid->getName() == "density"; };
    const bool by_density = std::any_of(volume.grids.begin(), volume.grids.end(), is_density);
    std::vector<Tear> out;
    for (const auto& grid : volume.grids) {
        if (by_density && !is_density(grid)) continue;
        const auto look = [&](const auto& values) {
            for (int axis = 0; axis < (lattice.closed ? 2 : 3); ++axis)
                for (const bool high : {false, true}) {
                    // A dimension of one vertex has no rims: its neighbours are as far away as can be.
                    if (carved[static_cast<std::size_t>(axis)] == 1) continue;
                    const double share = share_of(values, lattice, map, carved, {axis, high});
                    const bool far_end =
                        high && axis < 2 && std::any_of(map.steps().begin(), map.steps().end(), [&](const auto& step) { return step.axis() == axis; });
                    if (share > 0)
                        out.push_back({grid->getName(), fmt::format("{} = {}", "uvw"[axis], high ? lattice.shape[static_cast<std::size_t>(axis)] - 1 : 0),
                                       !far_end, share});
                }
        };
        if (const auto floats = openvdb::GridBase::grid<openvdb::FloatGrid>(grid)) look(*floats);
        else if (const auto doubles = openvdb::GridBase::grid<openvdb::DoubleGrid>(grid)) look(*doubles);
    }
    return out;
}

std::string to_text(const Tear& tear) {
    const auto share = tear.share >= 0.1 ? "more than 10 %" : tear.share >= 0.01 ? "1 to 10 %" : "less than 1 %";
    return fmt::format(
        "grid '{}' crosses the lattice's rim {} along {} of it, and is moved on the inner side only: it may tear there; let the lattice reach "
        "further{}",
        tear.grid, tear.rim, share, tear.faded_away ? ", or set `rim: fade`" : "");
}

}  // namespace fluidcarve
