#include "formats/vdb/vdb_file.h"
#include "nodes/vdb.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

using namespace fluidcarve;
using test::failure_of;
using test::NodeBench;

namespace {

const std::string plume = std::string(TEST_DATA) + "/plume/plume.####.vdb";

/// A context at one frame of a sequence, where only some outputs are wanted.
struct At {
    std::vector<int> frames;
    Context::Host host;
    Context operator()(int frame, std::vector<std::string> wanted = {"volume"}) {
        const auto place = std::ranges::find(frames, frame) - frames.begin();
        return Context(host, frames)
            .at(static_cast<std::size_t>(place))
            .wanting([wanted](std::string_view name) {
                return std::ranges::find(wanted, name) != wanted.end();
            });
    }
};

void put_frame(const Scratch& scratch, int frame) {
    Volume volume;
    volume.grids.push_back(FloatGrid::create(static_cast<float>(frame)));
    openvdb::ConstPtrCast<openvdb::GridBase>(volume.grids[0].grid())->setName("density");
    write_vdb(scratch / fmt::format("a.{:02}.vdb", frame), volume);
}

float background(const Payload& payload) {
    return openvdb::gridConstPtrCast<FloatGrid>(payload.as<Volume>()->grids.at(0))->background();
}

}  // namespace

TEST_CASE("vdb.read offers all grids as a volume and named ones typed, the same objects") {
    At at{{51, 52}, {}};
    NodeBench node(vdb_read(), "{path: " + plume +
                                   ", grids: {density: float, v: {name: velocity, type: vector}}}");
    REQUIRE(node.faults() == "");
    auto out = node.run({}, at(52, {"volume", "density", "v"}));
    const auto volume = out.at("volume").as<Volume>();
    CHECK(volume->names() == "velocity, density, shadow, temperature, flame");
    CHECK(out.at("density").type() == typeid(FloatGrid));
    CHECK(out.at("density").as<FloatGrid>() == volume->find("density"));
    CHECK(out.at("v").as<VectorGrid>() == volume->find("velocity"));
    CHECK(out.at("v").as<VectorGrid>()->getGridClass() == openvdb::GRID_STAGGERED);
}

TEST_CASE("vdb.read reads only the named grids that are wanted") {
    At at{{51}, {}};
    NodeBench node(vdb_read(), "{path: " + plume +
                                   ", grids: {density: float, velocity: vector, nonsense: float}}");
    auto out = node.run({}, at(51, {"density"}));
    CHECK(out.size() == 1);
    CHECK(test::difference(
              *out.at("density").as<FloatGrid>(),
              *read_vdb(std::string(TEST_DATA) + "/plume/plume.0051.vdb").find("density")) == "");
}

TEST_CASE(
    "vdb.read names the grids that are there when one is not, and both types when one is another") {
    At at{{51}, {}};
    const std::string path = std::string(TEST_DATA) + "/plume/plume.0051.vdb";
    const auto failure = [&](const std::string& grids) {
        NodeBench node(vdb_read(), "{path: " + plume + ", grids: {" + grids + "}}");
        return failure_of([&] { node.run({}, at(51, {"volume", "x"})); });
    };
    CHECK(failure("x: {name: velocty, type: vector}") ==
          path +
              " has no grid 'velocty'; it has velocity, density, shadow, temperature, flame; did "
              "you mean 'velocity'?");
    CHECK(failure("x: float") ==
          path + " has no grid 'x'; it has velocity, density, shadow, temperature, flame");
    CHECK(failure("x: {name: velocity, type: float}") ==
          path + ": grid 'velocity' is of type vec3s, not float; state it as vector");
    CHECK(failure("x: {name: density, type: vector}") ==
          path + ": grid 'density' is of type float, not vec3s; state it as float");

    const Scratch scratch;
    Volume volume;
    const auto grid = openvdb::DoubleGrid::create();
    grid->setName("x");
    volume.grids.push_back(grid);
    write_vdb(scratch / "double.vdb", volume);
    NodeBench node(vdb_read(), "{path: " + scratch / "double.vdb" + ", grids: {x: float}}");
    CHECK(failure_of([&] { node.run({}, at(51, {"x"})); }) ==
          scratch / "double.vdb" +
              ": grid 'x' is of type double, not float; only float and vec3s grids can be named, "
              "others travel within the volume");
}

TEST_CASE("what is wrong with vdb.read's parameters is said before anything is read") {
    const auto faults = [&](const std::string& rest) {
        return NodeBench(vdb_read(), "{path: a.vdb, " + rest + "}").faults();
    };
    CHECK(faults("grids: {density: flaot}") ==
          "grids must be float or vector, not 'flaot'; did you mean 'float'?\n");
    CHECK(faults("grids: {density: {type: float, nmae: x}}") ==
          "grids has no field 'nmae'; did you mean 'name'?\n");
    CHECK(faults("grids: {density: {name: x}}") == "grids lacks 'type': float or vector\n");
    CHECK(faults("grids: {volume: float}") ==
          "grids: vdb.read already has an output 'volume'; give this one another name: {density: "
          "{name: volume, type: float}}\n");
    CHECK(faults("missing: hold") ==
          "missing: 'hold' is for sequences; the path has no frame token such as ####\n");
}

TEST_CASE("a missing frame is an error, left out or held, as stated") {
    const Scratch scratch;
    for (const int frame : {3, 5}) put_frame(scratch, frame);
    const auto node = [&](const std::string& missing) {
        return NodeBench(vdb_read(),
                         "{path: " + scratch / "a.##.vdb" + ", missing: " + missing + "}");
    };

    const auto error = node("error").survey({2, 3, 4, 5});
    CHECK(error.left_out.empty());
    CHECK(error.absent ==
          std::map<int, std::string>{{2, scratch / "a.02.vdb" + " does not exist"},
                                     {4, scratch / "a.04.vdb" + " does not exist"}});

    const auto skip = node("skip").survey({2, 3, 4, 5});
    CHECK(skip.left_out == std::set<int>{2, 4});
    CHECK(skip.absent.empty());

    const auto hold = node("hold").survey({2, 3, 4, 5, 6});
    CHECK(hold.left_out.empty());
    CHECK(hold.absent.empty());
    At at{{2, 3, 4, 5, 6}, {}};
    std::vector<float> held;
    for (const int frame : at.frames)
        held.push_back(background(node("hold").run({}, at(frame)).at("volume")));
    CHECK(held == std::vector<float>{3, 3, 3, 5, 5});

    for (const auto* missing : {"skip", "hold", "error"})
        CHECK(node(missing).survey({7, 8}).absent ==
              std::map<int, std::string>{
                  {7, scratch / "a.07.vdb" + " does not exist, nor does any other frame"}});
}

TEST_CASE("a file without a frame token is looked for once") {
    CHECK(NodeBench(vdb_read(), "{path: /nowhere/a.vdb}").survey({1, 2, 3}).absent ==
          std::map<int, std::string>{{1, "/nowhere/a.vdb does not exist"}});
    CHECK(NodeBench(vdb_read(), "{path: " + std::string(TEST_DATA) + "/vdb/oiio_sphere.vdb}")
              .survey({1, 2, 3})
              .absent.empty());
}

TEST_CASE("vdb.read into vdb.write gives each frame's file as it was") {
    const Scratch scratch;
    At at{{51, 52}, {}};
    NodeBench read(vdb_read(), "{path: " + plume + "}");
    NodeBench write(vdb_write(), "{path: " + scratch / "out/smoke.%04d.vdb" + "}");
    for (const int frame : at.frames)
        write.run({{"source", {read.run({}, at(frame)).at("volume")}}}, at(frame));
    const auto before = read_vdb(std::string(TEST_DATA) + "/plume/plume.0052.vdb");
    const auto after = read_vdb(scratch / "out/smoke.0052.vdb");
    REQUIRE(after.names() == before.names());
    for (std::size_t n = 0; n < before.grids.size(); ++n)
        CHECK(test::difference(*before.grids[n].grid(), *after.grids[n].grid()) == "");
    CHECK(after.codec == "blosc");
    CHECK(std::distance(std::filesystem::directory_iterator(scratch / "out"), {}) == 2);
}

TEST_CASE("vdb.write compresses as it is told") {
    const Scratch scratch;
    At at{{52}, {}};
    NodeBench read(vdb_read(), "{path: " + plume + "}");
    NodeBench(vdb_write(), "{path: " + scratch / "out.vdb" + ", compression: none}")
        .run({{"source", {read.run({}, at(52)).at("volume")}}}, at(52));
    CHECK(read_vdb(scratch / "out.vdb").codec == "none");
    CHECK(NodeBench(vdb_write(), "{path: a.vdb, compression: lzma}").faults() ==
          "compression must be one of as_read, blosc, zip, none, not 'lzma'\n");
}
