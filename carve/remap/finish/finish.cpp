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

bool is_vectors(const openvdb::GridBase& grid) {
    return grid.isType<openvdb::Vec3SGrid>() || grid.isType<openvdb::Vec3DGrid>();
}

/// Finishes grids one after the other.
class Finisher {
public:
    Finisher(const Volume& carved, const Lattice& given, const CarveMap& map, const Finish& finish)
        : lattice_(map.extended(given)), map_(map), finish_(finish) {
        const bool level_sets = renormalizes() && map.soft() &&
                                std::ranges::any_of(carved.grids, [](const VolumeGrid& held) {
                                    return is_level_set(held.header());
                                });
        if (finish.densities.empty() && !finish.transform_vectors && !level_sets) return;
        mapping_.emplace(lattice_, map.reach());
        derivative_.emplace(*mapping_, map);
    }

    /// @param source  the grid before the carve
    /// @param held    the carved grid; becomes the finished one
    void finish(const VolumeGrid& source, VolumeGrid& held) const {
        if (is_level_set(held.header()) && renormalizes() && held != source) renew_distances(held);
        if (std::ranges::count(finish_.densities, held.name()) > 0)
            held = held.holding(mass_kept(source, held, places_of(held.header()), *derivative_));
        if (!finish_.transform_vectors) return;
        if (is_vectors(held.header()))
            held = vectors_turned(held, places_of(held.header()), *derivative_);
        if (is_point_grid(held.header())) {
            Points points;
            points.grid = held.grid();
            held = held.holding(vectors_turned(points, *derivative_).grid);
        }
    }

    /// Turns vectors in three parts.
    void turn_triplets(const Volume& carved, Volume& out) const {
        for (const auto& held : carved.grids) {
            const auto triplet = triplet_of(carved, held.header());
            if (!triplet || VolumeGrid(triplet->components[0]) != held) continue;
            const auto whole = merged(*triplet);
            const auto parts = split(vectors_turned(whole, places_of(*whole), *derivative_));
            for (std::size_t c = 0; c < 3; ++c)
                *std::ranges::find(out.grids, VolumeGrid(triplet->components[c])) = parts[c];
        }
    }

private:
    bool renormalizes() const { return finish_.renormalize.value_or(true); }
    CarvedPlaces places_of(const openvdb::GridBase& grid) const {
        return {lattice_, map_.reach(), grid.transform(), grid.transform()};
    }
    void renew_distances(VolumeGrid& held) const {
        auto grid = held.grid();
        if (derivative_ && derivative_->exact())
            held = grid = squeezed_smooth(grid, places_of(*grid), *derivative_);
        if (can_renormalize(*grid)) held = renormalized(grid, places_of(*grid), map_);
        else if (finish_.renormalize)
            throw Failure(
                fmt::format("level set '{}' can't be renormalized: its voxels are not cubes, "
                            "or its background is not above 0, or above 100 voxels",
                            grid->getName()));
    }

    const Lattice lattice_;
    const CarveMap& map_;
    const Finish& finish_;
    std::optional<Mapping> mapping_;
    std::optional<CarveDerivative> derivative_;
};

}  // namespace

Volume finished(const Volume& source, const Volume& carved, const Lattice& given,
                const CarveMap& map, const Finish& finish) {
    if (map.empty()) return carved;
    require_densities(carved, finish.densities);
    const Finisher finisher(carved, given, map, finish);
    Volume out = carved;
    for (std::size_t n = 0; n < out.grids.size(); ++n)
        finisher.finish(source.grids[n], out.grids[n]);
    if (finish.transform_vectors) finisher.turn_triplets(carved, out);
    return out;
}

}  // namespace fluidcarve
