#include "carve/stream/volume_stream.h"

#include "carve/base/values.h"
#include "carve/stream/grid_stream.h"

#include <memory>
#include <set>
#include <vector>

namespace fluidcarve {

namespace {

void write_pixels(const ChannelPixels& pixels, BinaryWriter& out) {
    for (const auto* const box : {&pixels.box, &pixels.stored})
        for (const auto& corner : {box->min(), box->max()}) out.value(corner);
    std::vector<float> values;
    values.reserve(pixels.stored.volume());
    for (int y = pixels.stored.min().y(); y <= pixels.stored.max().y(); ++y)
        for (int x = pixels.stored.min().x(); x <= pixels.stored.max().x(); ++x)
            values.push_back(pixels.at(x, y));
    out.list(values);
}

ChannelPixels read_pixels(BinaryReader& in) {
    ChannelPixels out;
    for (auto* const box : {&out.box, &out.stored}) {
        const auto low = in.value<openvdb::Coord>();
        *box = {low, in.value<openvdb::Coord>()};
    }
    const auto values = std::make_shared<std::vector<float>>(in.list<float>());
    BinaryReader::require(values->size() == out.stored.volume());
    out.values = std::shared_ptr<const float>(values, values->data());
    out.along_x = 1;
    out.along_y = out.stored.dim().x();
    return out;
}

}  // namespace

std::uint64_t Stored<Volume>::bytes(const Volume& volume) {
    std::set<const openvdb::TreeBase*> trees;
    std::uint64_t out = 0;
    for (const auto& grid : volume.grids)
        if (trees.insert(&grid.header().constBaseTree()).second) out += grid.bytes();
    return out;
}

void Stored<Volume>::write(const Volume& volume, std::ostream& to) {
    BinaryWriter out(to);
    out.value(std::uint64_t{volume.grids.size()});
    GridWriter grids(to);
    for (const auto& grid : volume.grids) {
        grids.write(grid.header());
        out.value(grid.pixels() != nullptr);
        if (grid.pixels()) write_pixels(*grid.pixels(), out);
    }
    write_metadata(volume.metadata, out);
    out.text(volume.codec);
}

Ref<Volume> Stored<Volume>::read(std::istream& from) {
    BinaryReader in(from);
    const auto out = std::make_shared<Volume>();
    GridReader grids(from);
    for (auto left = in.value<std::uint64_t>(); left > 0; --left) {
        const auto grid = grids.read();
        if (in.value<bool>()) out->grids.emplace_back(grid, read_pixels(in));
        else out->grids.emplace_back(grid);
    }
    out->metadata = read_metadata(in);
    out->codec = in.text();
    return out;
}

}  // namespace fluidcarve
