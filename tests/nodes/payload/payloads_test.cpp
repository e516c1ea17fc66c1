#include "carve/volume/volume.h"
#include "graph/types/registry.h"
#include "nodes/catalogue.h"
#include "nodes/payload/add_payloads.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

namespace {

Registry payloads() {
    Registry out;
    add_grid_payloads(out);
    return out;
}

}  // namespace

TEST_CASE(
    "a volume input takes any one grid, a grid input any typed one, and nothing converts back") {
    const auto registry = payloads();
    CHECK(registry.accepted_names(typeid(Volume)) == "volume, float, vector, mask or grid");
    CHECK(registry.accepted_names(typeid(AnyGrid)) == "grid, float, vector or mask");
    CHECK(registry.accepted_names(typeid(FloatGrid)) == "float");
    CHECK(registry.accepted_names(typeid(VectorGrid)) == "vector");
}

TEST_CASE("a grid converts to a volume of one without a copy") {
    const auto registry = payloads();
    const Ref<FloatGrid> grid = FloatGrid::create();
    const auto direct = registry.convert(Payload(grid), typeid(Volume)).as<Volume>();
    const auto any = registry.convert(Payload(grid), typeid(AnyGrid));
    const auto by_way_of_any = registry.convert(any, typeid(Volume)).as<Volume>();
    REQUIRE(direct->grids.size() == 1);
    CHECK(direct->grids[0] == grid);
    CHECK(by_way_of_any->grids[0] == grid);
    CHECK(direct->codec.empty());
}

TEST_CASE("a tree that grids of a volume share is counted once") {
    const auto registry = payloads();
    const auto grid = FloatGrid::create();
    grid->denseFill({{0, 0, 0}, {31, 31, 31}}, 1.0f);
    grid->tree().voxelizeActiveTiles();
    Volume volume;
    volume.grids = {grid, grid->copyGrid()};
    const auto bytes =
        registry.payload(typeid(Volume)).bytes(Payload(std::make_shared<Volume>(volume)));
    CHECK(bytes == grid->memUsage());
    CHECK(bytes > 32 * 32 * 32 * sizeof(float));
}

TEST_CASE("a volume finds its grids by name, the first of equal ones") {
    Volume volume;
    for (const auto* name : {"density", "heat", "density"}) {
        const auto grid = FloatGrid::create();
        grid->setName(name);
        volume.grids.push_back(grid);
    }
    CHECK(volume.find("density") == volume.grids[0]);
    CHECK(volume.find("heat") == volume.grids[1]);
    CHECK(volume.find("velocity") == nullptr);
    CHECK(volume.names() == "density, heat, density");
}

TEST_CASE("an input says what the kinds of its type take, and each kind takes that") {
    const auto registry = builtin_registry();
    const auto& loop = *registry.node("time.loop");
    CHECK(registry.accepted_names(loop, *loop.input("source")) ==
          "volume, float, vector, mask, grid, points or mesh");
    CHECK(registry.accepted_names(loop, *loop.input("velocity")) == "vector");
    for (const auto& [name, type] : registry.nodes())
        for (const auto& kind : type.kinds) {
            INFO(name << " as " << kind.type);
            REQUIRE(registry.node(kind.type));
            REQUIRE(registry.node(kind.type)->input(kind.input));
            CHECK(registry.node(kind.type)->input(kind.input)->type == kind.payload);
        }
}
