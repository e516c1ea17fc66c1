#include "nodes/payload/add_payloads.h"

#include "carve/stream/grid_stream.h"
#include "carve/stream/volume_stream.h"
#include "nodes/payload/picked_grid.h"

namespace fluidcarve {
namespace {

std::shared_ptr<Volume> volume_of(openvdb::GridBase::ConstPtr grid) {
    auto out = std::make_shared<Volume>();
    out->grids.push_back(std::move(grid));
    return out;
}

template <class Grid>
Filed<Grid> filed_grid() {
    return {1, [](const Grid& grid, std::ostream& to) { GridWriter(to).write(grid); },
            [](std::istream& from) -> Ref<Grid> { return GridReader(from).template read<Grid>(); }};
}

Filed<AnyGrid> filed_any() {
    return {1, [](const AnyGrid& any, std::ostream& to) { GridWriter(to).write(*any.grid); },
            [](std::istream& from) -> Ref<AnyGrid> {
                return std::make_shared<AnyGrid>(AnyGrid{GridReader(from).read()});
            }};
}

}  // namespace

void add_grid_payloads(Registry& registry) {
    registry.add(payload_type<FloatGrid>(
        "float", "A grid of numbers.", [](const FloatGrid& grid) { return grid.memUsage(); },
        filed_grid<FloatGrid>()));
    registry.add(payload_type<VectorGrid>(
        "vector", "A grid of vectors with three components.",
        [](const VectorGrid& grid) { return grid.memUsage(); }, filed_grid<VectorGrid>()));
    registry.add(payload_type<MaskGrid>(
        "mask", "A set of voxels: the active ones of a grid.",
        [](const MaskGrid& grid) { return grid.memUsage(); }, filed_grid<MaskGrid>()));
    registry.add(payload_type<AnyGrid>(
        "grid", "One grid of any type, also of points.",
        [](const AnyGrid& any) { return any.grid->memUsage(); }, filed_any()));
    registry.add(payload_type<Volume>(
        "volume", "All grids of one frame, in the order of their file.", &Stored<Volume>::bytes,
        {2, &Stored<Volume>::write, &Stored<Volume>::read}));

    registry.add(conversion<FloatGrid, AnyGrid>(
        [](const Ref<FloatGrid>& grid) { return std::make_shared<AnyGrid>(AnyGrid{grid}); }));
    registry.add(conversion<VectorGrid, AnyGrid>(
        [](const Ref<VectorGrid>& grid) { return std::make_shared<AnyGrid>(AnyGrid{grid}); }));
    registry.add(conversion<MaskGrid, AnyGrid>(
        [](const Ref<MaskGrid>& grid) { return std::make_shared<AnyGrid>(AnyGrid{grid}); }));
    registry.add(
        conversion<FloatGrid, Volume>([](const Ref<FloatGrid>& grid) { return volume_of(grid); }));
    registry.add(conversion<VectorGrid, Volume>(
        [](const Ref<VectorGrid>& grid) { return volume_of(grid); }));
    registry.add(
        conversion<MaskGrid, Volume>([](const Ref<MaskGrid>& grid) { return volume_of(grid); }));
    registry.add(
        conversion<AnyGrid, Volume>([](const Ref<AnyGrid>& any) { return volume_of(any->grid); }));
    add_grid_selections(registry);
}

}  // namespace fluidcarve
