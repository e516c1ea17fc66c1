#include "carve/field/same_transform.h"
#include "nodes/seam.h"

#include "carve/lattice/lattice.h"
#include "carve/solver/greedy.h"
#include "formats/vdb/vdb_file.h"
#include "nodes/vdb.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace fluidcarve;
using test::failure_of;
using test::NodeBench;

namespace {

FloatGrid::Ptr grid_of(double voxel) {
    const auto grid = FloatGrid::create();
    grid->tree().setValue({1, 1, 1}, 1);
    grid->setName("energy");
    grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
    return grid;
}

}  // namespace

TEST_CASE("a solver refuses energies whose voxels change from frame to frame, naming both frames") {
    static const std::vector<int> frames{13, 14};
    Context::Host host;
    NodeBench solver(seam_greedy(), "{count: -1}");
    const auto lattice =
        Payload(std::make_shared<Lattice>(make_box({0, 0, 0}, {4, 4, 4}, 0.125, {0, 1, 2})));
    const auto add = [&](std::size_t t, double voxel) {
        solver.add({{"energy", {Payload(grid_of(voxel))}}, {"lattice", {lattice}}},
                   Context(host, frames).at(t));
    };
    add(0, 0.125);
    CHECK(failure_of([&] { add(1, 0.12); }) ==
          "the energy has voxels of 0.125 x 0.125 x 0.125, the first at [0, 0, 0] in frame 13, but "
          "voxels of 0.12 x 0.12 x 0.12, the first at [0, 0, 0] in "
          "frame 14: no lattice fits both; bake the sequence with a fixed domain, or make its "
          "voxels alike with grid.resample");
    for (const auto& at : {openvdb::Vec3d(0.3, 0, 0), openvdb::Vec3d(-5, 1, 0)}) {
        const auto moved = grid_of(0.125);
        moved->transform().postTranslate(at);
        solver.add({{"energy", {Payload(moved)}}, {"lattice", {lattice}}},
                   Context(host, frames).at(1));
    }
}

TEST_CASE("a reader warns of a domain that grows, even where its voxels stay") {
    const Scratch scratch;
    for (const int frame : {1, 2, 3}) {
        const auto grid = grid_of(0.1);
        grid->insertMeta("file_base_resolution",
                         openvdb::Vec3IMetadata({8, 8, 7 + std::min(frame, 2)}));
        write_vdb(scratch / fmt::format("a.{}.vdb", frame), Volume{{grid}, {}, {}});
    }
    const auto said =
        NodeBench(vdb_read(), "{path: " + (scratch / "a.#.vdb") + "}").survey({1, 2, 3});
    CHECK(said.warnings ==
          std::vector<std::string>{
              "grid 'energy' has voxels of 0.1 x 0.1 x 0.1, the first at [0, 0, 0] in a domain of "
              "[8, 8, 8] in frame 1, but voxels of 0.1 x 0.1 x "
              "0.1, the first at [0, 0, 0] in a domain of [8, 8, 9] in frame 2 (an adaptive "
              "domain?): no lattice fits both; bake with a fixed domain"});
}
