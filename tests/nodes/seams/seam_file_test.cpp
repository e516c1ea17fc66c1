#include "nodes/seams/seam_file.h"
#include "nodes/io/vdb_file.h"
#include "nodes/seams/read.h"
#include "nodes/seams/write.h"
#include "tests/support/node_bench.h"
#include "tests/support/reference_carve.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::Vec3d;

namespace {

Seams some_seams(Axis axis = Axis::u, Seams::Kind kind = Seams::Kind::remove, int count = 3) {
    std::mt19937 random(2);
    const auto lattice = make_box(Vec3d(0), {7, 5, 4}, 0.5, {0, 1, 2});
    auto out = random_seams(random, lattice, lattice.shape, axis, kind, count, {11, 13, 15});
    for (std::size_t n = 0; n < out.seams.size(); ++n) out.seams[n].energy = 1.0 / 3 + static_cast<double>(n);
    return out;
}

bool equal(const Seams& a, const Seams& b) {
    bool same = a.axis == b.axis && a.kind == b.kind && a.shape == b.shape && a.frames == b.frames && a.lattice == b.lattice &&
                a.lattice_hash == b.lattice_hash && a.closed == b.closed;
    for (const auto window : {&Seams::seams, &Seams::pairs}) {
        same = same && (a.*window).size() == (b.*window).size();
        for (std::size_t n = 0; same && n < (a.*window).size(); ++n)
            same = (a.*window)[n].at == (b.*window)[n].at && (a.*window)[n].energy == (b.*window)[n].energy;
    }
    return same;
}

Seams some_pairs(Axis axis, Seams::Kind kind) {
    std::mt19937 random(3);
    const auto lattice = make_box(Vec3d(0), {7, 8, 4}, 0.5, {0, 1, 2});
    auto out = random_pairs(random, lattice, lattice.shape, axis, kind, 2, {11, 13, 15});
    for (std::size_t n = 0; n < 2; ++n) {
        out.seams[n].energy = 1.0 / 3 + static_cast<double>(n);
        out.pairs[n].energy = 1.0 / 7 + static_cast<double>(n);
    }
    return out;
}

/// A seam volume after `edit`, and what is said of it.
std::string fault(const std::function<void(Volume&, std::vector<FloatGrid::Ptr>&)>& edit, Seams::Kind kind = Seams::Kind::remove, bool pairs = false) {
    auto volume = seams_to_volume(pairs ? some_pairs(Axis::u, kind) : some_seams(Axis::u, kind));
    std::vector<FloatGrid::Ptr> grids;
    for (const auto& grid : volume.grids) grids.push_back(openvdb::GridBase::grid<FloatGrid>(grid->deepCopyGrid()));
    for (std::size_t n = 0; n < grids.size(); ++n) volume.grids[n] = grids[n];
    edit(volume, grids);
    try {
        seams_from_volume(volume);
    } catch (const Failure& failure) {
        CHECK(failure.kind == Failure::Kind::input);
        return failure.what();
    }
    return {};
}

std::string metadata_fault(const char* name, const std::string& value) {
    return fault([&](Volume& volume, auto&) {
        volume.metadata.removeMeta(name);
        if (!value.empty()) volume.metadata.insertMeta(name, openvdb::StringMetadata(value));
    });
}

}  // namespace

TEST_CASE("seams come back from their file as they were") {
    const Scratch scratch;
    for (const auto& seams : {some_seams(), some_seams(Axis::v), some_seams(Axis::u, Seams::Kind::insert), some_seams(Axis::v, Seams::Kind::remove, 0)}) {
        write_seams(scratch / "seams.vdb", seams);
        CHECK(equal(read_seams(scratch / "seams.vdb"), seams));
    }
}

TEST_CASE("pairs, and that their lattice is closed, come back from their file") {
    const Scratch scratch;
    for (const auto axis : {Axis::u, Axis::v})
        for (const auto kind : {Seams::Kind::remove, Seams::Kind::insert}) {
            auto seams = some_pairs(axis, kind);
            seams.closed = axis == Axis::u;
            write_seams(scratch / "seams.vdb", seams);
            CHECK(equal(read_seams(scratch / "seams.vdb"), seams));
        }
    const auto volume = seams_to_volume(some_pairs(Axis::u, Seams::Kind::remove));
    CHECK(volume.names() == "seam.0000, seam.0000.pair, seam.0001, seam.0001.pair");
    CHECK(volume.grids[0]->metaValue<std::string>("kind") == "remove");
    CHECK(volume.grids[1]->metaValue<std::string>("kind") == "insert");
    CHECK(volume.grids[3]->metaValue<double>("energy") == 1.0 / 7 + 1);
    CHECK(!volume.metadata["fluidcarve_closed"]);
}

TEST_CASE("a file of pairs that is wrong is refused with the reason") {
    const auto pair_fault = [](const auto& edit, Seams::Kind kind = Seams::Kind::remove) { return fault(edit, kind, true); };
    CHECK(pair_fault([](Volume& volume, auto&) { volume.grids.pop_back(); }) ==
          "the 3 grids must be float grids named 'seam.0000' to 'seam.0001.pair', but there are seam.0000, seam.0000.pair, seam.0001");
    CHECK(pair_fault([](Volume&, auto& grids) { grids[1]->insertMeta("kind", openvdb::StringMetadata("remove")); }) ==
          "grid 'seam.0000.pair' says remove as 'seam.0000' does, but one of a pair removes and the other inserts");
    CHECK(pair_fault([](Volume&, auto& grids) { grids[1]->tree().setValueOn(Coord(4, 0, 2), 6); }) ==
          "grid 'seam.0000.pair' has 6 at (4, 0, 2), but wants a whole number from 0 to 5");
    CHECK(pair_fault([](Volume&, auto& grids) { grids[3]->tree().setValueOn(Coord(4, 0, 2), 6); }, Seams::Kind::insert) ==
          "grid 'seam.0001.pair' has 6 at (4, 0, 2), but wants a whole number from 0 to 5");
    CHECK(pair_fault([](Volume&, auto& grids) {
              grids[0]->tree().setValueOn(Coord(4, 0, 2), 3);
              grids[2]->tree().setValueOn(Coord(4, 0, 2), 3);
              grids[1]->tree().setValueOn(Coord(4, 0, 2), 5);
              grids[3]->tree().setValueOn(Coord(4, 0, 2), 4);
          }) == "at (4, 0, 2) a pair takes entry 4, but must be above all seams of the first window, which reach 4");
    CHECK(metadata_fault("fluidcarve_closed", "maybe") == "'fluidcarve_closed' wants true or false, not 'maybe'");
}

TEST_CASE("a seam file is what the contract says, to any reader of .vdb") {
    const Scratch scratch;
    const auto seams = some_seams(Axis::v);
    write_seams(scratch / "seams.vdb", seams);
    const auto volume = read_vdb(scratch / "seams.vdb");
    CHECK(volume.names() == "seam.0000, seam.0001, seam.0002");
    const auto say = [&](const char* name) { return volume.metadata.metaValue<std::string>(name); };
    CHECK(say("fluidcarve_axis") == "v");
    CHECK(say("fluidcarve_shape") == "7,5,4,3");
    CHECK(say("fluidcarve_frames") == "11-15x2");
    CHECK(say("fluidcarve_lattice") == "box of 7 x 5 x 4 vertices from (0, 0, 0) to (3, 2, 1.5), spacing 0.5, axes xyz");
    CHECK(say("fluidcarve_lattice_hash") == seams.lattice_hash);
    const auto grid = openvdb::GridBase::grid<FloatGrid>(volume.find("seam.0001"));
    REQUIRE(grid);
    CHECK(grid->metaValue<std::string>("kind") == "remove");
    CHECK(grid->metaValue<double>("energy") == 1.0 / 3 + 1);
    CHECK(grid->activeVoxelCount() == 7 * 4 * 3);
    CHECK(grid->tree().getValue(Coord(6, 2, 1)) == float(seams.seams[1].at[6 + 7 * 2 + 28 * 1]));
}

TEST_CASE("a seam file that is wrong is refused with the reason") {
    CHECK(metadata_fault("fluidcarve_axis", "") == "the file has no text 'fluidcarve_axis' in its metadata, so it is no seam file");
    CHECK(metadata_fault("fluidcarve_axis", "w") == "'fluidcarve_axis' wants u or v, not 'w'");
    CHECK(metadata_fault("fluidcarve_shape", "7,5,4") == "'fluidcarve_shape' wants four numbers from 1 to 65535, I,J,K,T, not '7,5,4'");
    CHECK(metadata_fault("fluidcarve_shape", "7,5,4,3,") == "'fluidcarve_shape' wants four numbers from 1 to 65535, I,J,K,T, not '7,5,4,3,'");
    CHECK(metadata_fault("fluidcarve_shape", "7,5,400000,3") == "'fluidcarve_shape' wants four numbers from 1 to 65535, I,J,K,T, not '7,5,400000,3'");
    CHECK(metadata_fault("fluidcarve_frames", "1-2") == "'fluidcarve_frames' lists 2 frames, but 'fluidcarve_shape' 3");
    CHECK(metadata_fault("fluidcarve_lattice_hash", "") == "the file has no text 'fluidcarve_lattice_hash' in its metadata, so it is no seam file");
    const auto entry = [](float value) { return fault([=](Volume&, auto& grids) { grids[1]->tree().setValueOn(Coord(4, 0, 2), value); }); };
    CHECK(entry(2.5f) == "grid 'seam.0001' has 2.5 at (4, 0, 2), but wants a whole number from 0 to 5");
    CHECK(entry(6) == "grid 'seam.0001' has 6 at (4, 0, 2), but wants a whole number from 0 to 5");
    CHECK(entry(-1) == "grid 'seam.0001' has -1 at (4, 0, 2), but wants a whole number from 0 to 5");
    CHECK(entry(NAN) == "grid 'seam.0001' has nan at (4, 0, 2), but wants a whole number from 0 to 5");
    CHECK(fault([](Volume&, auto& grids) { grids[0]->tree().setValueOff(Coord(4, 0, 2)); }) ==
          "grid 'seam.0000' has 59 active voxels, but wants one for each of 60 columns");
    CHECK(fault([](Volume&, auto& grids) {
              grids[0]->tree().setValueOff(Coord(4, 0, 2));
              grids[0]->tree().setValueOn(Coord(5, 0, 2), 1);
          }) == "grid 'seam.0000' has nothing at (4, 0, 2), but wants a whole number from 0 to 6");
    CHECK(fault([](Volume&, auto& grids) { grids[0]->tree().setValueOn(Coord(4, 0, 2), 6); }, Seams::Kind::insert) ==
          "grid 'seam.0000' has 6 at (4, 0, 2), but wants a whole number from 0 to 5");
    CHECK(fault([](Volume&, auto& grids) { grids[1]->tree().setValueOn(Coord(4, 0, 2), grids[0]->tree().getValue(Coord(4, 0, 2))); }, Seams::Kind::insert)
              .find("at (4, 0, 2), which another seam doubles too") != std::string::npos);
    CHECK(fault([](Volume&, auto& grids) { grids[1]->insertMeta("kind", openvdb::StringMetadata("insert")); }) ==
          "grid 'seam.0001' says insert, but 'seam.0000' says remove");
    CHECK(fault([](Volume&, auto& grids) { grids[1]->insertMeta("kind", openvdb::StringMetadata("delete")); }) ==
          "grid 'seam.0001' has the kind 'delete'; known: remove, insert");
    CHECK(fault([](Volume&, auto& grids) { grids[1]->removeMeta("energy"); }) == "grid 'seam.0001' has no number 'energy' in its metadata");
    CHECK(fault([](Volume& volume, auto&) { volume.grids[1] = openvdb::Int32Grid::create(); }) ==
          "the 3 grids must be float grids named 'seam.0000' to 'seam.0002', but there are seam.0000, , seam.0002");
}

TEST_CASE("a fault names the file, and a missing file is told before a run") {
    const Scratch scratch;
    Volume volume;
    volume.grids = {FloatGrid::create()};
    write_vdb(scratch / "other.vdb", volume);
    CHECK(failure_of([&] { read_seams(scratch / "other.vdb"); }) ==
          (scratch / "other.vdb") + ": the file has no text 'fluidcarve_axis' in its metadata, so it is no seam file");
    const NodeBench bench(seams_read(), "{path: " + (scratch / "none.vdb") + "}");
    CHECK(bench.survey({4, 5}).absent == std::map<int, std::string>{{4, (scratch / "none.vdb") + " does not exist"}});
    CHECK(NodeBench(seams_read(), "{path: seams.####.vdb}").faults() ==
          "path: parameter 'path' can't have a frame token: one file holds the seams of all frames\n");
}

TEST_CASE("seams.write and seams.read pass seams through a file") {
    const Scratch scratch;
    const auto seams = std::make_shared<Seams>(some_seams());
    const auto yaml = "{path: " + (scratch / "seams.vdb") + "}";
    NodeBench(seams_write(), yaml).run({{"seams", {Payload(seams)}}});
    CHECK(equal(*NodeBench(seams_read(), yaml).run({}).at("seams").as<Seams>(), *seams));
}
