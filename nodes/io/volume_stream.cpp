#include "nodes/io/volume_stream.h"

#include "nodes/io/grid_stream.h"

#include <set>

namespace fluidcarve {

std::uint64_t bytes_of(const Volume& volume) {
    std::set<const openvdb::TreeBase*> trees;
    std::uint64_t out = 0;
    for (const auto& grid : volume.grids)
        if (trees.insert(&grid->constBaseTree()).second) out += grid->memUsage();
    return out;
}

void write_volume(const Volume& volume, std::ostream& to) {
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

}  // namespace fluidcarve
