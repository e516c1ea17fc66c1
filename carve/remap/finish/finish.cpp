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
                                std::ranges::any_of(carved.grids, [](const VolumeGrid& each) {
                                    return is_level_set(each.header());
                                });
        if (finish.densities.empty() && !finish.transform_vectors && !level_sets) return;
        mapping_.emplace(lattice_, map.reach());
        derivative_.emplace(*mapping_, map);
    }

    /// @param source  the grid before the carve
    /// @param out    the carved grid; becomes the finished one
    void finish(const VolumeGrid& source, VolumeGrid& out) const {
        if (is_level_set(out.header()) && renormalizes() && out != source) renew_distances(out);
        if (std::ranges::count(finish_.densities, out.name()) > 0)
            out = out.holding(mass_kept(source, out, places_of(out.header()), *derivative_));
        if (!finish_.transform_vectors) return;
        if (is_vectors(out.header()))
            out = vectors_turned(out, places_of(out.header()), *derivative_);
        if (is_point_grid(out.header())) {
            Points points;
            points.grid = out.grid();
            out = out.holding(vectors_turned(points, *derivative_).grid);
        }
    }

    /// Turns vectors in three parts.
    void turn_triplets(const Volume& carved, Volume& out) const {
        for (const auto& each : carved.grids) {
            const auto triplet = triplet_of(carved, each.header());
            if (!triplet || VolumeGrid(triplet->components[0]) != each) continue;
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
    void renew_distances(VolumeGrid& out) const {
        auto grid = out.grid();
        if (derivative_ && derivative_->exact())
            out = grid = squeezed_smooth(grid, places_of(*grid), *derivative_);
        if (can_renormalize(*grid)) out = renormalized(grid, places_of(*grid), map_);
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
