#include "nodes/payload/picked_grid.h"

#include "carve/base/failure.h"
#include "carve/grid/named_grids.h"
#include "carve/volume/triplet.h"
#include "carve/volume/volume.h"

#include <fmt/format.h>

namespace fluidcarve {

namespace {

/// The grids of a name: one, or the three of a triplet.
/// @throws Failure if there are none
std::vector<openvdb::GridBase::ConstPtr> picked(const Volume& volume, const std::string& name) {
    if (auto grid = volume.find(name)) return {std::move(grid)};
    std::vector<openvdb::GridBase::ConstPtr> out;
    for (const auto& each : triplet_names(name))
        if (auto grid = volume.find(each); grid && grid->isType<FloatGrid>())
            out.push_back(std::move(grid));
    if (out.size() == 3) return out;
    throw Failure(lacks_grid(name, volume.given_names()));
}

openvdb::GridBase::ConstPtr picked_as_one(const Volume& volume, const std::string& name) {
    const auto grids = picked(volume, name);
    if (grids.size() == 1) return grids.front();
    const auto component = [&](std::size_t n) {
        return openvdb::gridConstPtrCast<FloatGrid>(grids[n]);
    };
    return merged(make_triplet(name, {component(0), component(1), component(2)}));
}

template <class Grid>
Ref<Grid> picked_as(const Volume& volume, const std::string& name, const char* wanted) {
    const auto grid = picked_as_one(volume, name);
    if (auto out = openvdb::gridConstPtrCast<Grid>(grid)) return out;
    throw Failure(
        fmt::format("has the grid '{}' as {}, not as {}", name, grid->valueType(), wanted));
}

}  // namespace

void add_grid_selections(Registry& registry) {
    registry.add(selection<Volume, FloatGrid>([](const Volume& volume, const std::string& name) {
        return picked_as<FloatGrid>(volume, name, "float");
    }));
    registry.add(selection<Volume, VectorGrid>([](const Volume& volume, const std::string& name) {
        return picked_as<VectorGrid>(volume, name, "vec3s");
    }));
    registry.add(selection<Volume, AnyGrid>([](const Volume& volume, const std::string& name) {
        return std::make_shared<AnyGrid>(AnyGrid{picked_as_one(volume, name)});
    }));
    registry.add(selection<Volume, Volume>([](const Volume& volume, const std::string& name) {
        const auto out = std::make_shared<Volume>();
        if (const auto place = volume.place(name)) {
            out->grids.push_back(volume.grids[*place]);
        } else {
            const auto parts = picked(volume, name);
            out->grids.assign(parts.begin(), parts.end());
        }
        return out;
    }));
}

}  // namespace fluidcarve
