#include "carve/remap/finish/tears.h"

#include "carve/field/extent.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace fluidcarve {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;

/// About how many vertices of a rim are checked.
constexpr double most_vertices_of_rim = 4096;

/// A face of the carved box of vertices.
struct Rim {
    int axis;
    bool high;
};

/// Where the content of a carved vertex comes from; nothing if a removal frees it.
std::optional<Coord> origin_of(const CarveMap& map, Coord vertex) {
    for (auto step = map.steps().rbegin(); step != map.steps().rend(); ++step) {
        const int axis = step->axis(), entry = vertex[axis], lateral = vertex[step->lateral_axis()],
                  slice = vertex[step->slice_axis()];
        if (!step->columns().has(vertex) || entry < step->low() || entry > step->high()) continue;
        if (!step->carves(vertex.asVec3d(), 1)) {
            if (step->frees(vertex.asVec3d())) return std::nullopt;
            continue;
        }
        vertex[axis] +=
            step->warps()
                ? static_cast<int>(std::lround(step->soft()->entry(entry, lateral, slice)))
                : step->displacement(entry, lateral, slice) / 2;
    }
    return vertex;
}

/// Whether a displacement ends at a rim with a jump. There is no jump at the anchored end of its
/// own axis.
bool jumps(const CarveMap& map, const Rim& rim, const Coord& by) {
    const auto moves_end = [&](int axis) {
        return std::ranges::any_of(map.steps(), [&](const CarveStep& step) {
            const auto [begin, end] = step.common();
            return step.axis() == axis &&
                   (rim.high ? std::max<double>(step.last(), step.last_before()) > end
                             : std::min(step.start(), step.origin()) < begin);
        });
    };
    for (int axis = 0; axis < 3; ++axis)
        if (by[axis] != 0 && (axis == rim.axis ? moves_end(axis) : !map.rims_fade())) return true;
    return false;
}

/// The entry at a column's end. A warp's end differs from column to column.
int rim_entry(const CarveMap& map, const openvdb::CoordBBox& carved, const Rim& rim,
              const Coord& column) {
    int out = (rim.high ? carved.max() : carved.min())[rim.axis];
    for (const auto& step : map.steps()) {
        if (!step.warps() || step.axis() != rim.axis || !step.columns().has(column)) continue;
        const auto [begin, end] = step.ends(column.asVec3d(), 1);
        out = std::clamp(static_cast<int>(rim.high ? std::floor(end) : std::ceil(begin)),
                         step.start(), step.last());
    }
    return out;
}

template <class GridT>
double share_of(const GridT& grid, const Lattice& lattice, const CarveMap& map,
                const openvdb::CoordBBox& before, const openvdb::CoordBBox& carved,
                const Rim& rim) {
    const int a = rim.axis == 0 ? 1 : 0, b = rim.axis == 2 ? 1 : 2;
    const auto size = carved.dim();
    const int stride = static_cast<int>(std::ceil(
        std::sqrt(std::max(1.0, static_cast<double>(size[a]) * size[b] / most_vertices_of_rim))));
    auto values = grid.getConstAccessor();
    const auto holds = [&](const Vec3d& at) {
        typename GridT::ValueType value;
        const auto voxel = voxel_at(grid.worldToIndex(lattice.position(at)));
        return voxel && values.probeValue(*voxel, value) && value != grid.background();
    };
    // Distance beyond the rim that is checked: a vertex, but at least a voxel.
    const double beyond = std::max(1.0, grid.voxelSize().x() / lattice.spacing);
    int all = 0, torn = 0;
    Coord vertex;
    for (vertex[a] = carved.min()[a]; vertex[a] <= carved.max()[a]; vertex[a] += stride)
        for (vertex[b] = carved.min()[b]; vertex[b] <= carved.max()[b]; vertex[b] += stride) {
            ++all;
            vertex[rim.axis] = rim_entry(map, carved, rim, vertex);
            const auto from = origin_of(map, vertex);
            if (!from || !jumps(map, rim, *from - vertex)) continue;
            const auto inside = from->asVec3d();
            auto outside = inside;
            outside[rim.axis] =
                rim.high ? before.max()[rim.axis] + beyond : before.min()[rim.axis] - beyond;
            torn += holds(inside) && holds(outside);
        }
    return static_cast<double>(torn) / all;
}

}  // namespace

std::vector<Tear> find_tears(const Volume& volume, const Lattice& given, const CarveMap& map) {
    const auto lattice = map.extended(given);
    const Coord first(map.below().data());
    const openvdb::CoordBBox before(first, first + Coord(given.shape.data()) - Coord(1));
    auto carved = before;
    for (const auto& step : map.steps()) {
        carved.min()[step.axis()] = step.start();
        carved.max()[step.axis()] = step.last();
    }
    const auto is_density = [](const auto& grid) { return grid.name() == "density"; };
    const bool by_density = std::ranges::any_of(volume.grids, is_density);
    std::vector<Tear> out;
    for (const auto& each : volume.grids) {
        if (by_density && !is_density(each)) continue;
        const auto grid = each.grid();
        const auto look = [&](const auto& values) {
            for (int axis = 0; axis < (lattice.closed ? 2 : 3); ++axis)
                for (const bool high : {false, true}) {
                    // A dimension of one vertex has no rims. Around a rig only u has one, the
                    // outer.
                    if (carved.dim()[axis] == 1 ||
                        (lattice.around && (axis == 1 || (axis == 0 && !high))))
                        continue;
                    const double share =
                        share_of(values, lattice, map, before, carved, {axis, high});
                    const bool own_end = std::ranges::any_of(
                        map.steps(), [&](const auto& step) { return step.axis() == axis; });
                    if (share > 0)
                        out.push_back(
                            {grid->getName(),
                             fmt::format(
                                 "{} = {}", "uvw"[axis],
                                 high ? given.shape[static_cast<std::size_t>(axis)] - 1 : 0),
                             !own_end, share});
                }
        };
        if (const auto floats = openvdb::GridBase::grid<openvdb::FloatGrid>(grid)) look(*floats);
        else if (const auto doubles = openvdb::GridBase::grid<openvdb::DoubleGrid>(grid))
            look(*doubles);
    }
    return out;
}

std::string to_text(const Tear& tear) {
    const auto share = tear.share >= 0.1    ? "more than 10 %"
                       : tear.share >= 0.01 ? "1 to 10 %"
                                            : "less than 1 %";
    return fmt::format(
        "grid '{}' crosses the lattice's rim {} along {} of the rim, and only the part inside the "
        "lattice moves: it may tear there; make the lattice larger{}",
        tear.grid, tear.rim, share, tear.faded_away ? ", or set `rim: fade`" : "");
}

}  // namespace fluidcarve
