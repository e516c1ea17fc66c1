#include "nodes/io/payload_types.h"

#include "nodes/io/grid_stream.h"
#include "nodes/io/picked_grid.h"

#include <set>

namespace fluidcarve {
namespace {

std::shared_ptr<Volume> volume_of(openvdb::GridBase::ConstPtr grid) {
    auto out = std::make_shared<Volume>();
    out->grids.push_back(std::move(grid));
    return out;
}

/// Bytes of memory of a volume. Trees shared by several grids count once.
std::uint64_t bytes_of(const Volume& volume) {
    std::set<const openvdb::TreeBase*> trees;
    std::uint64_t out = 0;
    for (const auto& grid : volume.grids)
        if (trees.insert(&grid->constBaseTree()).second) out += grid->memUsage();
    return out;
}

template <class Grid>
Filed<Grid> filed_grid() {
    return {1, [](const Grid& grid, std::ostream& to) { GridWriter(to).write(grid); },
            [](std::istream& from) -> Ref<Grid> { return GridReader(from).template read<Grid>(); }};
}

Filed<AnyGrid> filed_any() {
    return {1, [](const AnyGrid& any, std::ostream& to) { GridWriter(to).write(*any.grid); },
            [](std::istream& from) -> Ref<AnyGrid> { return std::make_shared<AnyGrid>(AnyGrid{GridReader(from).read()}); }};
}

void write(const Volume& volume, std::ostream& to) {
    BinaryWriter out(to);
    out.value(std::uint64_t{volume.grids.size()});
    GridWriter grids(to);
    for (const auto& grid : volume.grids) grids.write(*grid);
    write_metadata(volume.metadata, out);
    out.text(volume.codec);
}

Ref<Volume> read_volume(std::istream& from) {
    BinaryReader in(from);
    const auto out = std::make_shared<Volume>();
    GridReader grids(from);
    for (auto left = in.value<std::uint64_t>(); left > 0; --left) out->grids.push_back(grids.read());
    out->metadata = read_metadata(in);
    out->codec = in.text();
    return out;
}

}  // namespace

void add_payloads(Registry& registry) {
    registry.add(payload_type<FloatGrid>(
        "float", "A grid of numbers.", [](const FloatGrid& grid) { return grid.memUsage(); }, filed_grid<FloatGrid>()));
    registry.add(payload_type<VectorGrid>(
        "vector", "A grid of vectors with three components.", [](const VectorGrid& grid) { return grid.memUsage(); }, filed_grid<VectorGrid>()));
    registry.add(payload_type<MaskGrid>(
        "mask", "A set of voxels: the active ones of a grid.", [](const MaskGrid& grid) { return grid.memUsage(); }, filed_grid<MaskGrid>()));
    registry.add(payload_type<AnyGrid>(
        "grid", "One grid of any type, also of points.", [](const AnyGrid& any) { return any.grid->memUsage(); }, filed_any()));
    registry.add(payload_type<Volume>("volume", "All grids of one frame, in the order of their file.", &bytes_of, {1, &write, &read_volume}));

    registry.add(conversion<FloatGrid, AnyGrid>([](const Ref<FloatGrid>& grid) { return std::make_shared<AnyGrid>(AnyGrid{grid}); }));
    registry.add(conversion<VectorGrid, AnyGrid>([](const Ref<VectorGrid>& grid) { return std::make_shared<AnyGrid>(AnyGrid{grid}); }));
    registry.add(conversion<MaskGrid, AnyGrid>([](const Ref<MaskGrid>& grid) { return std::make_shared<AnyGrid>(AnyGrid{grid}); }));
    registry.add(conversion<FloatGrid, Volume>([](const Ref<FloatGrid>& grid) { return volume_of(grid); }));
    registry.add(conversion<VectorGrid, Volume>([](const Ref<VectorGrid>& grid) { return volume_of(grid); }));
    registry.add(conversion<MaskGrid, Volume>([](const Ref<MaskGrid>& grid) { return volume_of(grid); }));
    registry.add(conversion<AnyGrid, Volume>([](const Ref<AnyGrid>& any) { return volume_of(any->grid); }));
    add_grid_selections(registry);
}

}  // namespace fluidcarve
