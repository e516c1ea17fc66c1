#include "carve/field/dense.h"
#include "nodes/energy.h"
#include "nodes/field.h"
#include "nodes/mask.h"

#include "carve/energy/gradient.h"
#include "carve/energy/kinetic.h"
#include "carve/energy/surface.h"
#include "carve/energy/volume.h"
#include "carve/energy/vorticity.h"
#include "carve/field/curl.h"
#include "carve/field/curvature.h"
#include "carve/field/filter.h"
#include "carve/field/gradient.h"
#include "carve/field/laplacian.h"
#include "carve/field/stencil.h"
#include "carve/mask/dilate.h"
#include "nodes/energy_image.h"
#include "tests/support/node_bench.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace fluidcarve;
using openvdb::Coord;
using test::failure_of;
using test::NodeBench;

namespace {

constexpr std::uint64_t gigabyte = 1'000'000'000;

/// A grid with one active tile of 4096^3 voxels.
template <class Grid>
typename Grid::Ptr tile(const std::string& name, const typename Grid::ValueType& value) {
    const auto out = Grid::create();
    out->setName(name);
    out->tree().root().addTile(Coord(0), value, true);
    return out;
}

Context scarce() { return Context().limits({gigabyte, "."}); }

}  // namespace

TEST_CASE("what tiles take as voxels is counted before it is made") {
    const auto grid = tile<FloatGrid>("density", 1);
    CHECK(failure_of([&] { require_dense_fits(*grid, sizeof(float), 8 * gigabyte); }) ==
          "grid 'density' has 68719476736 active voxels, 68719476736 of them in tiles; as voxels "
          "these would take 275 GB, but --memory allows 8.00 GB: crop the "
          "grid, or raise --memory");
    CHECK(failure_of([&] { require_dense_fits(*grid, sizeof(float), 300 * gigabyte); }) == "");
    CHECK(grid_fits(6e7, 0));
}

TEST_CASE("nodes refuse tiles that would not fit as voxels") {
    const auto payload = [](const auto& grid) { return std::vector{Payload(grid)}; };
    const auto density = payload(tile<FloatGrid>("density", 1));
    const auto velocity = tile<VectorGrid>("velocity", openvdb::Vec3s(1));
    velocity->setGridClass(openvdb::GRID_STAGGERED);
    const auto flow = payload(velocity);
    const auto mask = payload(tile<MaskGrid>("mask", true));
    const auto image = std::vector{
        Payload(std::make_shared<const Volume>(Volume{{tile<FloatGrid>("Y", 1)}, {}, {}}))};
    const auto refused = [](const NodeType& type, const std::string& input,
                            const std::vector<Payload>& payloads, const std::string& yaml = "{}") {
        INFO(type.name);
        CHECK_THAT(failure_of([&] {
                       NodeBench(type, yaml, {{input, 1}}).run({{input, payloads}}, scarce());
                   }),
                   Catch::Contains("68719476736 active voxels"));
    };
    for (const auto& type : {energy_gradient(), field_gradient(), field_laplacian(),
                             field_curvature(), field_filter()})
        refused(type, "field", density);
    for (const auto& type : {energy_vorticity(), energy_kinetic(), field_curl()})
        refused(type, "velocity", flow);
    refused(energy_volume(), "fields", density, "range: [0, 1]");
    refused(energy_surface(), "surface", density, "range: [0, 1]");
    refused(energy_image(), "source", image);
    refused(mask_dilate(), "mask", mask, "voxels: 64");
}

TEST_CASE("the borders of the last tile of index space are opened") {
    constexpr int last = std::numeric_limits<int>::max() - 7;
    FloatGrid grid;
    grid.tree().addTile(1, Coord(last), 1.0f, true);
    open_tile_borders(grid.tree());
    CHECK(grid.tree().leafCount() == 1);
    CHECK(grid.tree().probeConstLeaf(Coord(last)));
    CHECK(grid.activeVoxelCount() == 512);
}
