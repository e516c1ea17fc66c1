#include "carve/remap/finish/finish.h"

#include "carve/base/failure.h"
#include "carve/remap/finish/level_set.h"
#include "carve/remap/finish/squeezed.h"
#include "carve/remap/finish/transport.h"
#include "carve/stream/openvdb_types.h"
#include "carve/volume/triplet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace fluidcarve {

namespace {

bool is_level_set(const openvdb::GridBase& grid) {
    return grid.getGridClass() == openvdb::GRID_LEVEL_SET &&
           (grid.isType<openvdb::FloatGrid>() || grid.isType<openvdb::DoubleGrid>());
}

void require_densities(const Volume& volume, const std::vector<std::string>& names) {
    for (const auto& name : names) {
        const auto grid = volume.find(name);
        if (!grid)
            throw Failure(
                fmt::format("there is no grid '{}' to conserve; there are {}: name in `densities:` "
                            "those that hold amounts per volume",
                            name, volume.names()));
        if ((!grid->isType<openvdb::FloatGrid>() && !grid->isType<openvdb::DoubleGrid>()) ||
            is_level_set(*grid))
            throw Failure(fmt::format(
                "grid '{}' is no density ({}, class {}); take it out of `densities:`", name,
                grid->type(), openvdb::GridBase::gridClassToString(grid->getGridClass())));
    }
}

}  // namespace

Volume finished(const Volume& source, const Volume& carved, const Lattice& given,
                const CarveMap& map, const Finish& finish) {
    if (map.empty()) return carved;
    require_densities(carved, finish.densities);
    const auto lattice = map.extended(given);
    std::optional<Mapping> mapping;
    std::optional<CarveDerivative> derivative;
    const bool level_sets = finish.renormalize.value_or(true) && map.soft() &&
                            std::ranges::any_of(carved.grids, [](const VolumeGrid& held) {
                                return is_level_set(held.header());
                            });
    if (!finish.densities.empty() || finish.transform_vectors || level_sets) {
        mapping.emplace(lattice, map.reach());
        derivative.emplace(*mapping, map);
    }
    const auto places_of = [&](const openvdb::GridBase& grid) {
        return CarvedPlaces(lattice, map.reach(), grid.transform(), grid.transform());
    };

    Volume out = carved;
    for (std::size_t n = 0; n < out.grids.size(); ++n) {
        auto& held = out.grids[n];
        if (is_level_set(held.header()) && finish.renormalize.value_or(true) &&
            held != source.grids[n]) {
            auto grid = held.grid();
            if (derivative && derivative->exact())
                held = grid = squeezed_smooth(grid, places_of(*grid), *derivative);
            if (can_renormalize(*grid)) {
                held = renormalized(grid, places_of(*grid), map);
            } else if (finish.renormalize) {
                throw Failure(
                    fmt::format("level set '{}' can't be renormalized: its voxels are not cubes, "
                                "or its background is not above 0",
                                grid->getName()));
            }
        }
        if (std::count(finish.densities.begin(), finish.densities.end(), held.name()) > 0)
            held = held.holding(
                mass_kept(source.grids[n], held, places_of(held.header()), *derivative));
        if (finish.transform_vectors && (held.header().isType<openvdb::Vec3SGrid>() ||
                                         held.header().isType<openvdb::Vec3DGrid>()))
            held = vectors_turned(held, places_of(held.header()), *derivative);
        if (finish.transform_vectors && is_point_grid(held.header())) {
            Points points;
            points.grid = held.grid();
            held = held.holding(vectors_turned(points, *derivative).grid);
        }
    }
    if (!finish.transform_vectors) return out;

    for (const auto& held : carved.grids) {
        const auto triplet = triplet_of(carved, held.header());
        if (!triplet || VolumeGrid(triplet->components[0]) != held) continue;
        const auto whole = merged(*triplet);
        const auto parts = split(vectors_turned(whole, places_of(*whole), *derivative));
        for (std::size_t c = 0; c < 3; ++c)
            *std::find(out.grids.begin(), out.grids.end(), VolumeGrid(triplet->components[c])) =
                parts[c];
    }
    return out;
}

}  // namespace fluidcarve
