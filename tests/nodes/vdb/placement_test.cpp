#include "carve/remap/grid.h"
#include "carve/stream/raw_grid.h"
#include "carve/volume/stored_form.h"
#include "carve/volume/triplet.h"
#include "formats/vdb/conventions.h"
#include "nodes/vdb.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"
#include "tests/support/vdb_grid.h"

#include <fmt/format.h>
#include <openvdb/io/File.h>
#include <catch2/catch.hpp>

using namespace fluidcarve;
using openvdb::Coord;
using openvdb::Vec3d;
using test::difference;
using test::failure_of;
using test::NodeBench;

namespace {

const std::string frame_51 = std::string(TEST_DATA) + "/plume/plume.0051.vdb";

struct Frame1 {
    std::vector<int> frames{1};
    Context::Host host;
    Context operator()() { return Context(host, frames).at(0); }
};

/// A velocity as three grids, each on its faces, with one face more along its own axis.
Volume houdini_volume() {
    Volume out;
    for (int axis = 0; axis < 3; ++axis) {
        const auto grid = FloatGrid::create(0);
        for (int x = 0; x < 9 + (axis == 0); ++x)
            for (int y = 0; y < 6 + (axis == 1); ++y)
                for (int z = 0; z < 4 + (axis == 2); ++z)
                    grid->tree().setValue({x, y, z},
                                          static_cast<float>(100 * x + 10 * y + z + 1000 * axis));
        const auto transform = openvdb::math::Transform::createLinearTransform(0.2);
        Vec3d at(1, 2, 3);
        at[axis] -= 0.1;
        transform->postTranslate(at);
        grid->setTransform(transform);
        grid->setName(triplet_names("vel")[static_cast<std::size_t>(axis)]);
        grid->setSaveFloatAsHalf(axis == 1);
        grid->insertMeta("axis", openvdb::Int32Metadata(axis));
        out.grids.push_back(grid);
    }
    return out;
}

void require_same(const Volume& a, const Volume& b) {
    REQUIRE(a.names() == b.names());
    for (std::size_t n = 0; n < a.grids.size(); ++n)
        CHECK(difference(*a.grids[n].grid(), *b.grids[n].grid()) == "");
}

/// OpenVDB's registry without one grid type.
struct Forgotten {
    using Grid = openvdb::Grid<openvdb::tree::Tree4<float, 5, 4, 2>::Type>;
    Forgotten() { Grid::registerGrid(); }
    void forget() const { Grid::unregisterGrid(); }
    ~Forgotten() {
        if (Grid::isRegistered()) Grid::unregisterGrid();
    }
};

}  // namespace

TEST_CASE(
    "a reader's placement moves the grids into the shot's world, and the writer takes it back to "
    "the last bit") {
    const Scratch scratch;
    Frame1 frame;
    NodeBench reader(vdb_read(),
                     "{path: " + frame_51 +
                         ", grids: {velocity: vector}, translate: [0.1, -3.3, 7.7], scale: 3.7}");
    const auto out = reader.run({}, frame());
    const auto was = read_vdb(frame_51);
    const auto density = out.at("volume").as<Volume>()->find("density");
    const auto at = was.find("density")->indexToWorld(Vec3d(5, 6, 7)) * 3.7 + Vec3d(0.1, -3.3, 7.7);
    CHECK((density->indexToWorld(Vec3d(5, 6, 7)) - at).length() < 1e-12);
    CHECK(out.at("velocity").as<VectorGrid>()->transform() == density->transform());

    NodeBench writer(vdb_write(), "{path: " + (scratch / "out.vdb") + "}");
    writer.run({{"source", {out.at("volume")}}}, frame());
    require_same(was, read_vdb(scratch / "out.vdb"));
    writer.run({{"source",
                 {Payload(std::make_shared<Volume>(
                     Volume{{out.at("velocity").as<VectorGrid>()}, {}, {}}))}}},
               frame());
    CHECK(difference(*was.find("velocity"), *read_vdb_grid(scratch / "out.vdb", "velocity")) == "");
}

TEST_CASE("a stated placement of the writer is undone in grids that no reader placed") {
    const Scratch scratch;
    Frame1 frame;
    const auto grid = FloatGrid::create();
    grid->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
    NodeBench writer(vdb_write(),
                     "{path: " + (scratch / "out.vdb") + ", translate: [1, 2, 3], scale: 2}");
    writer.run({{"source", {Payload(std::make_shared<Volume>(Volume{{grid}, {}, {}}))}}}, frame());
    const auto back = read_vdb_grid(scratch / "out.vdb", "");
    CHECK((back->indexToWorld(Vec3d(0)) - Vec3d(-0.5, -1, -1.5)).length() < 1e-12);
    CHECK(back->voxelSize().x() == Approx(0.25));
}

TEST_CASE("vel.x, vel.y and vel.z are read as one staggered vector and written back as they came") {
    const Scratch scratch;
    Frame1 frame;
    const auto was = houdini_volume();
    write_vdb(scratch / "in.vdb", was);
    for (const auto* placement : {"", ", translate: [4, 5, 6.1], scale: 0.3"}) {
        NodeBench reader(vdb_read(), "{path: " + (scratch / "in.vdb") + ", grids: {vel: vector}" +
                                         placement + "}");
        const auto out = reader.run({}, frame());
        const auto vel = out.at("vel").as<VectorGrid>();
        CHECK(vel->getGridClass() == openvdb::GRID_STAGGERED);
        CHECK(vel->tree().getValue({3, 2, 1}) == openvdb::Vec3s(321, 1321, 2321));
        CHECK(vel->tree().isValueOn({9, 5, 3}));
        if (*placement == '\0')
            CHECK((vel->indexToWorld(Vec3d(0)) - Vec3d(1, 2, 3)).length() < 1e-12);
        for (const auto& source :
             {out.at("volume"), Payload(std::make_shared<Volume>(Volume{{vel}, {}, {}}))}) {
            NodeBench writer(vdb_write(), "{path: " + (scratch / "out.vdb") + "}");
            writer.run({{"source", {source}}}, frame());
            require_same(was, read_vdb(scratch / "out.vdb"));
        }
    }
}

TEST_CASE(
    "a changed triplet is written as three grids with the names, places and metadata that they "
    "had") {
    const Scratch scratch;
    const auto was = houdini_volume();
    const auto vel = merged(*triplet_of(was, *was.grids[1].grid()));
    const auto changed = vel->deepCopy();
    changed->tree().setValue({3, 2, 1}, openvdb::Vec3s(-1, -2, -3));
    write_vdb(scratch / "out.vdb", Volume{{changed}, {}, {}});
    const auto out = read_vdb(scratch / "out.vdb");
    REQUIRE(out.names() == "vel.x, vel.y, vel.z");
    for (int axis = 0; axis < 3; ++axis) {
        const auto& grid =
            static_cast<const FloatGrid&>(*out.grids[static_cast<std::size_t>(axis)].grid());
        CHECK(grid.tree().getValue({3, 2, 1}) == static_cast<float>(-1 - axis));
        CHECK(grid.tree().getValue({0, 5, 3}) == static_cast<float>(53 + 1000 * axis));
        CHECK(grid.activeVoxelCount() ==
              was.grids[static_cast<std::size_t>(axis)]->activeVoxelCount());
        CHECK(grid.metaValue<std::int32_t>("axis") == axis);
        CHECK(grid.transform() == was.grids[static_cast<std::size_t>(axis)]->transform());
        CHECK(grid.saveFloatAsHalf() == (axis == 1));
    }
}

TEST_CASE("three grids that are no vector are told apart") {
    auto volume = houdini_volume();
    const auto odd = openvdb::gridPtrCast<FloatGrid>(volume.grids[2]->deepCopyGrid());
    odd->setTransform(openvdb::math::Transform::createLinearTransform(0.3));
    volume.grids[2] = odd;
    CHECK_FALSE(triplet_of(volume, *volume.grids[0].grid()));
    const Scratch scratch;
    Frame1 frame;
    write_vdb(scratch / "in.vdb", volume);
    CHECK(failure_of([&] {
              NodeBench(vdb_read(), "{path: " + (scratch / "in.vdb") + ", grids: {vel: vector}}")
                  .run({}, frame());
          }) ==
          "grids 'vel.x', 'vel.y' and 'vel.z' are no vector: their transforms are neither the same "
          "nor half a voxel apart, each along its axis; read them as "
          "three float grids");
}

TEST_CASE("the components of a staggered triplet travel with their voxel's index") {
    const auto volume = houdini_volume();
    const auto lattice = make_box(Vec3d(1, 2, 3), {9, 6, 4}, 0.2, {0, 1, 2});
    Seams seams;
    seams.shape = lattice.shape;
    seams.frames = {1};
    seams.lattice_hash = lattice.hash;
    seams.seams = {{std::vector<std::uint16_t>(24, 4), 0}};
    const CarveMap map(lattice, {std::make_shared<const Seams>(seams)}, 1, std::nullopt);
    const auto out = carve_volume(volume, lattice, map, Interpolation::linear);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto& before = static_cast<const FloatGrid&>(*volume.grids[axis].grid()).tree();
        const auto& after = static_cast<const FloatGrid&>(*out.grids[axis].grid()).tree();
        for (int x = 0; x < 8; ++x)
            CHECK(after.getValue({x, 3, 2}) == before.getValue({x + (x >= 4), 3, 2}));
    }
}

TEST_CASE("a grid type that OpenVDB does not know is kept byte for byte, and only so") {
    openvdb::initialize();
    const Scratch scratch;
    const Forgotten type;
    const auto grid = Forgotten::Grid::create(2.5f);
    grid->tree().setValue({1, 2, 3}, 7.0f);
    grid->tree().setValue({100, -200, 3}, -1.0f);
    grid->setName("rare");
    grid->setTransform(openvdb::math::Transform::createLinearTransform(0.3));
    grid->insertMeta("note", openvdb::StringMetadata("keep me"));
    const auto plain = FloatGrid::create(1.0f);
    plain->setName("plain");
    openvdb::io::File(scratch / "in.vdb")
        .write(openvdb::GridCPtrVec{grid, plain, grid->copyGrid()});
    type.forget();

    const auto volume = read_vdb(scratch / "in.vdb");
    CHECK(volume.names() == "rare, plain, rare");
    REQUIRE(RawGrid::of(*volume.grids[0].grid()));
    CHECK(volume.grids[0]->type() == "Tree_float_5_4_2");
    CHECK(volume.grids[0]->metaValue<std::string>("note") == "keep me");
    CHECK(&volume.grids[0]->constBaseTree() == &volume.grids[2]->constBaseTree());
    write_vdb(scratch / "out.vdb", volume);
    CHECK(failure_of([&] { write_vdb(scratch / "other.vdb", volume, Codec::none); }) ==
          fmt::format("cannot write {}: grid 'rare' is of type Tree_float_5_4_2, which OpenVDB "
                      "does not know, and can't be compressed again; set 'compression: "
                      "as_read', or leave it out",
                      scratch / "other.vdb"));

    Forgotten::Grid::registerGrid();
    openvdb::io::File file(scratch / "out.vdb");
    file.open(false);
    const auto back = file.getGrids();
    REQUIRE(back->size() == 3);
    CHECK(difference(*grid, *file.readGrid("rare[0]")) == "");
    CHECK(difference(*plain, *file.readGrid("plain")) == "");
    const auto rare = [](const auto& each) { return each->getName() == "rare"; };
    const auto first = std::ranges::find_if(*back, rare),
               second = std::ranges::find_if(std::next(first), back->end(), rare);
    CHECK(&(*first)->constBaseTree() == &(*second)->constBaseTree());
}

TEST_CASE(
    "whose files they are is seen by their grids and marks, and their names are found by the "
    "common ones") {
    const Scratch scratch;
    const auto named = [&](const std::vector<std::string>& names, const std::string& creator = {}) {
        Volume volume;
        for (const auto& name : names) {
            const auto grid = FloatGrid::create();
            grid->setName(name);
            volume.grids.push_back(grid);
        }
        if (!creator.empty())
            volume.metadata.insertMeta("creator", openvdb::StringMetadata(creator));
        write_vdb(scratch / "f.vdb", volume);
        return read_vdb_header(scratch / "f.vdb");
    };
    const auto detected = [](const VdbHeader& header) {
        const auto* const found = detected_conventions(header);
        return found ? std::string(found->name) : std::string();
    };
    CHECK(detected(read_vdb_header(frame_51)) == "blender");
    CHECK(detected(read_vdb_header(std::string(TEST_DATA) + "/vdb/oiio_sphere.vdb")) == "houdini");
    CHECK(detected(named({"density", "vel.x", "vel.y", "vel.z"})) == "houdini");
    CHECK(detected(named({"density", "flames"})) == "embergen");
    CHECK(detected(named({"density", "flames", "vel"})) == "embergen");
    CHECK(name_in_file(named({"density", "flames", "vel"}), conventions_of("embergen"),
                       "velocity") == "vel");
    CHECK(detected(named({"voxel_fog_density"})) == "bifrost");
    CHECK(detected(named({"density"})) == "");
    CHECK(detected(named({"heat", "voxel_velocity"})) == "");

    CHECK(name_in_file(named({"density", "heat"}), conventions_of("houdini"), "temperature") ==
          "heat");
    CHECK(name_in_file(named({"vel.x", "vel.y", "vel.z"}), conventions_of("houdini"), "velocity") ==
          "vel");
    CHECK(name_in_file(named({"velocity", "vel"}), conventions_of("houdini"), "velocity") ==
          "velocity");
    CHECK(name_in_file(named({"voxel_velocity"}), nullptr, "velocity") == "velocity");
    CHECK(name_in_file(named({"other"}), conventions_of("bifrost"), "density") == "density");
}

TEST_CASE("one pipeline reads the velocities of any application") {
    const Scratch scratch;
    Frame1 frame;
    write_vdb(scratch / "houdini.vdb", houdini_volume());
    const auto bifrost = VectorGrid::create(openvdb::Vec3s(1, 2, 3));
    bifrost->setName("voxel_velocity");
    write_vdb(scratch / "bifrost.vdb", Volume{{bifrost}, {}, {}});
    const auto read = [&](const std::string& path, const std::string& more = {}) {
        return NodeBench(vdb_read(), "{path: " + path + ", grids: {velocity: vector}" + more + "}")
            .run({}, frame())
            .at("velocity")
            .as<VectorGrid>();
    };
    CHECK(read(frame_51)->getName() == "velocity");
    CHECK(read(scratch / "houdini.vdb")->getName() == "vel");
    CHECK(read(scratch / "bifrost.vdb")->background() == openvdb::Vec3s(1, 2, 3));
    CHECK(failure_of([&] { read(scratch / "bifrost.vdb", ", profile: none"); }) ==
          (scratch / "bifrost.vdb") + " has no grid 'velocity'; it has voxel_velocity");
    const auto plain = VectorGrid::create();
    plain->setName("velocity");
    write_vdb(scratch / "old.vdb", Volume{{plain}, {}, {}});
    CHECK(read(scratch / "old.vdb", ", profile: blender")->getGridClass() ==
          openvdb::GRID_STAGGERED);
    CHECK(read(scratch / "old.vdb")->getGridClass() == openvdb::GRID_UNKNOWN);

    // The class is the reader's guess, and stays out of what is written.
    for (const bool stated : {false, true}) {
        if (stated) plain->setGridClass(openvdb::GRID_UNKNOWN);
        write_vdb(scratch / "old.vdb", Volume{{plain}, {}, {}});
        write_vdb(scratch / "again.vdb",
                  Volume{{read(scratch / "old.vdb", ", profile: blender, scale: 3")}, {}, {}});
        CHECK(difference(*plain, *read_vdb_grid(scratch / "again.vdb", "velocity")) == "");
    }
}

TEST_CASE(
    "what is wrong in any frame is told before the first is read: a cut file, a grid missing, "
    "voxels that change") {
    const Scratch scratch;
    for (int frame = 1; frame <= 4; ++frame) {
        Volume volume;
        const auto grid = FloatGrid::create();
        grid->setName(frame == 3 ? "smoke" : "density");
        grid->setTransform(openvdb::math::Transform::createLinearTransform(frame == 4 ? 0.2 : 0.1));
        volume.grids.push_back(grid);
        write_vdb(scratch / fmt::format("a.{:02}.vdb", frame), volume);
    }
    const auto whole = Scratch::read(scratch / "a.02.vdb");
    scratch.write("a.02.vdb", whole.substr(0, whole.size() - 5));
    NodeBench node(vdb_read(), "{path: " + (scratch / "a.##.vdb") + ", grids: {density: float}}");
    const auto said = node.survey({1, 2, 3, 4});
    CHECK(
        said.absent.at(2) ==
        fmt::format(
            "{} is cut off: grid 'density' ends at byte {}, the file at {}; copy or write it again",
            scratch / "a.02.vdb", whole.size(), whole.size() - 5));
    CHECK(said.absent.at(3) == (scratch / "a.03.vdb") + " has no grid 'density'; it has smoke");
    CHECK(said.absent.size() == 2);
    CHECK(said.warnings ==
          std::vector<std::string>{"grid 'density' has voxels of 0.1 x 0.1 x 0.1, the first at [0, "
                                   "0, 0] in frame 1, but voxels of 0.2 x 0.2 x 0.2, the first at "
                                   "[0, 0, 0] in frame 4 (an adaptive domain?): no lattice fits "
                                   "both; bake with a fixed domain"});
}

TEST_CASE("a reader says before a run where the voxels of all frames lie, in the shot's world") {
    const Scratch scratch;
    for (int frame = 1; frame <= 3; ++frame) {
        const auto grid = FloatGrid::create();
        grid->setName("density");
        grid->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
        if (frame < 3) grid->fill({Coord(2 * frame, 0, 0), Coord(2 * frame + 1, 1, 1)}, 1, true);
        write_vdb(scratch / fmt::format("a.{:02}.vdb", frame), Volume{{grid}, {}, {}});
    }
    const NodeBench reader(vdb_read(),
                           "{path: " + (scratch / "a.##.vdb") +
                               ", grids: {density: float}, translate: [10, 0, 0], scale: 2}");
    const auto region = [&](const std::vector<int>& frames) {
        return reader.survey(frames).regions.at("density");
    };
    // A voxel more on all sides.
    REQUIRE(region({1, 2, 3}).boxes.size() == 1);
    CHECK(to_text(region({1, 2, 3}).boxes[0]) == "(11, -1, -1) to (16, 2, 2)");
    CHECK(region({3}).boxes.empty());
}
