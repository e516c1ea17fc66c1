#include "formats/seam_file/seam_file.h"
#include "formats/seam_file/seam_metadata.h"
#include "formats/vdb/vdb_file.h"
#include "nodes/seams.h"
#include "tests/support/files/edited_seams.h"
#include "tests/support/node_bench.h"
#include "tests/support/reference_carve.h"
#include "tests/support/scratch.h"
#include "tests/support/seams_through.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::Vec3d;

namespace {

Seams some_seams(Axis axis = Axis::u, Seams::Kind kind = Seams::Kind::remove, int count = 3) {
    std::mt19937 random(2);
    const auto lattice = make_box(Vec3d(0), {7, 5, 4}, 0.5, {0, 1, 2});
    auto out = random_seams(random, lattice, lattice.shape, axis, kind, count, {11, 13, 15});
    for (std::size_t n = 0; n < out.seams.size(); ++n)
        out.seams[n].energy = 1.0 / 3 + static_cast<double>(n);
    return out;
}

bool equal(const Seams& a, const Seams& b) {
    bool same = seam_texts(a) == seam_texts(b) && a.kind == b.kind;
    for (const auto window : {&Seams::seams, &Seams::pairs}) {
        same = same && (a.*window).size() == (b.*window).size();
        for (std::size_t n = 0; same && n < (a.*window).size(); ++n)
            same = (a.*window)[n].at == (b.*window)[n].at &&
                   (a.*window)[n].energy == (b.*window)[n].energy;
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
std::string fault(const SeamEdit& edit, Seams::Kind kind = Seams::Kind::remove,
                  bool pairs = false) {
    return fault_after(
        seams_to_volume(pairs ? some_pairs(Axis::u, kind) : some_seams(Axis::u, kind)), edit);
}

std::string metadata_fault(const char* name, const std::string& value) {
    return fault([&](Volume& volume, auto&) { restate(volume, name, value); });
}

/// What the file at a path says of seams, within a second; nothing if it is refused.
std::optional<Seams> read_or_refused(const std::string& path) {
    const auto begin = std::chrono::steady_clock::now();
    std::optional<Seams> out;
    try {
        out = read_seams(path);
    } catch (const Failure& failure) {
        CHECK(failure.kind == Failure::Kind::input);
    }
    CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(1));
    return out;
}

/// So many removals, each at entry 1 in all columns.
Seams straight(const std::array<int, 3>& shape, std::vector<int> frames, std::size_t count) {
    const auto lattice = make_box(Vec3d(0), {shape[0], shape[1], 1}, 1, {0, 1, 2});
    auto out = no_seams(lattice, Axis::u, Seams::Kind::remove, std::move(frames));
    out.shape = shape;
    for (std::size_t n = 0; n < count; ++n) out.seams.push_back(straight_seam(out, 1));
    return out;
}

constexpr auto changed =
    "the file is damaged or was changed: its content does not match its checksum; write it again, "
    "or remove the metadata 'fluidcarve_checksum' if you changed "
    "it on purpose";

}  // namespace

TEST_CASE("seams come back from their file as they were") {
    const Scratch scratch;
    for (const auto& seams :
         {some_seams(), some_seams(Axis::v), some_seams(Axis::u, Seams::Kind::insert),
          some_seams(Axis::v, Seams::Kind::remove, 0), some_seams(Axis::w)}) {
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

TEST_CASE(
    "seams around a rig come back from their file, and must leave out the rig, be carved along u, "
    "and keep the rig in place") {
    const Scratch scratch;
    const auto lattice = make_box(Vec3d(0), {7, 5, 4}, 1, {0, 1, 2});
    auto seams = no_seams(lattice);
    seams.around = true;
    seams.seams.push_back(straight_seam(seams, 2));
    write_seams(scratch / "seams.vdb", seams);
    CHECK(equal(read_seams(scratch / "seams.vdb"), seams));
    CHECK(read_seams(scratch / "seams.vdb").around);

    const auto refused = [&](const auto& edit, const std::string& why) {
        auto wrong = seams;
        edit(wrong);
        CHECK_THROWS_WITH(seams_from_volume(seams_to_volume(wrong)), why);
    };
    refused([](Seams& it) { it.seams[0] = straight_seam(it, 0); },
            "grid 'seam.0000' has 0 at (0, 0, 0), but must have a whole number from 1 to 6");
    refused(
        [](Seams& it) {
            it.window = Window{0, 4};
        },
        "'fluidcarve_window' must be two vertices from 1 to 6, first,last, not '0,4'");
    const auto* const fixed =
        "'fluidcarve_around' is true, but seams around a rig are carved along u, and the rig stays "
        "in place";
    refused([](Seams& it) { it.anchor.at = Anchor::At::high; }, fixed);
    refused(
        [](Seams& it) {
            it.axis = Axis::v;
            it.seams[0] = straight_seam(it, 2);
        },
        fixed);
}

TEST_CASE("a file of pairs that is wrong is refused with the reason") {
    const auto pair_fault = [](const auto& edit, Seams::Kind kind = Seams::Kind::remove) {
        return fault(edit, kind, true);
    };
    CHECK(pair_fault([](Volume& volume, auto&) { volume.grids.pop_back(); }) ==
          "the 3 grids must be float grids named 'seam.0000' to 'seam.0001.pair', but there are "
          "seam.0000, seam.0000.pair, seam.0001");
    CHECK(pair_fault([](Volume&, auto& grids) {
              grids[1]->insertMeta("kind", openvdb::StringMetadata("remove"));
          }) ==
          "grid 'seam.0000.pair' says remove as 'seam.0000' does, but one of a pair removes and "
          "the other inserts");
    CHECK(
        pair_fault([](Volume&, auto& grids) { grids[1]->tree().setValueOn(Coord(4, 0, 2), 6); }) ==
        "grid 'seam.0000.pair' has 6 at (4, 0, 2), but must have a whole number from 0 to 5");
    CHECK(pair_fault([](Volume&, auto& grids) { grids[3]->tree().setValueOn(Coord(4, 0, 2), 6); },
                     Seams::Kind::insert) ==
          "grid 'seam.0001.pair' has 6 at (4, 0, 2), but must have a whole number from 0 to 5");
    CHECK(pair_fault([](Volume&, auto& grids) {
              grids[0]->tree().setValueOn(Coord(4, 0, 2), 3);
              grids[2]->tree().setValueOn(Coord(4, 0, 2), 3);
              grids[1]->tree().setValueOn(Coord(4, 0, 2), 5);
              grids[3]->tree().setValueOn(Coord(4, 0, 2), 4);
          }) ==
          "at (4, 0, 2) a pair takes entry 4, but must be above all seams of the first window, "
          "which reach 4");
    CHECK(metadata_fault("fluidcarve_around", "maybe") ==
          "'fluidcarve_around' must be true or false, not 'maybe'");
    CHECK(metadata_fault("fluidcarve_closed", "maybe") ==
          "'fluidcarve_closed' must be true or false, not 'maybe'");
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
    CHECK(say("fluidcarve_lattice") ==
          "box of 7 x 5 x 4 vertices from (0, 0, 0) to (3, 2, 1.5), spacing 0.5, axes xyz");
    CHECK(say("fluidcarve_lattice_hash") == seams.lattice_hash);
    const auto grid = openvdb::GridBase::grid<FloatGrid>(volume.find("seam.0001"));
    REQUIRE(grid);
    CHECK(grid->metaValue<std::string>("kind") == "remove");
    CHECK(grid->metaValue<double>("energy") == 1.0 / 3 + 1);
    CHECK(grid->activeVoxelCount() == 7 * 4 * 3);
    CHECK(grid->tree().getValue(Coord(6, 2, 1)) == float(seams.seams[1].at[6 + 7 * 2 + 28 * 1]));
}

TEST_CASE("a seam file that is wrong is refused with the reason") {
    CHECK(metadata_fault("fluidcarve_axis", "") ==
          "the file has no text 'fluidcarve_axis' in its metadata, so it is no seam file");
    CHECK(metadata_fault("fluidcarve_axis", "x") ==
          "'fluidcarve_axis' must be u, v, w or t, not 'x'");
    CHECK(metadata_fault("fluidcarve_shape", "7,5,4") ==
          "'fluidcarve_shape' must be four numbers from 1 to 65535, I,J,K,T, not '7,5,4'");
    CHECK(metadata_fault("fluidcarve_shape", "7,5,4,3,") ==
          "'fluidcarve_shape' must be four numbers from 1 to 65535, I,J,K,T, not '7,5,4,3,'");
    CHECK(metadata_fault("fluidcarve_shape", "7,5,400000,3") ==
          "'fluidcarve_shape' must be four numbers from 1 to 65535, I,J,K,T, not '7,5,400000,3'");
    CHECK(metadata_fault("fluidcarve_frames", "1-2") ==
          "'fluidcarve_frames' lists 2 frames, but 'fluidcarve_shape' 3");
    CHECK(metadata_fault("fluidcarve_lattice_hash", "") ==
          "the file has no text 'fluidcarve_lattice_hash' in its metadata, so it is no seam file");
    const auto entry = [](float value) {
        return fault(
            [=](Volume&, auto& grids) { grids[1]->tree().setValueOn(Coord(4, 0, 2), value); });
    };
    CHECK(entry(2.5f) ==
          "grid 'seam.0001' has 2.5 at (4, 0, 2), but must have a whole number from 0 to 5");
    CHECK(entry(6) ==
          "grid 'seam.0001' has 6 at (4, 0, 2), but must have a whole number from 0 to 5");
    CHECK(entry(-1) ==
          "grid 'seam.0001' has -1 at (4, 0, 2), but must have a whole number from 0 to 5");
    CHECK(entry(NAN) ==
          "grid 'seam.0001' has nan at (4, 0, 2), but must have a whole number from 0 to 5");
    CHECK(fault([](Volume&, auto& grids) { grids[0]->tree().setValueOff(Coord(4, 0, 2)); }) ==
          "grid 'seam.0000' has 59 active voxels, but must have one for each of 60 columns");
    CHECK(fault([](Volume&, auto& grids) {
              grids[0]->tree().setValueOff(Coord(4, 0, 2));
              grids[0]->tree().setValueOn(Coord(5, 0, 2), 1);
          }) ==
          "grid 'seam.0000' has active voxels from (0, 0, 0) to (5, 3, 2), but must have the "
          "columns from (0, 0, 0) to (4, 3, 2)");
    CHECK(fault([](Volume&, auto& grids) { grids[0]->tree().setValueOn(Coord(4, 0, 2), 6); },
                Seams::Kind::insert) ==
          "grid 'seam.0000' has 6 at (4, 0, 2), but must have a whole number from 0 to 5");
    CHECK(fault(
              [](Volume&, auto& grids) {
                  grids[1]->tree().setValueOn(Coord(4, 0, 2),
                                              grids[0]->tree().getValue(Coord(4, 0, 2)));
              },
              Seams::Kind::insert)
              .find("at (4, 0, 2), which another seam doubles too") != std::string::npos);
    CHECK(fault([](Volume&, auto& grids) {
              grids[1]->insertMeta("kind", openvdb::StringMetadata("insert"));
          }) == "grid 'seam.0001' says insert, but 'seam.0000' says remove");
    CHECK(fault([](Volume&, auto& grids) {
              grids[1]->insertMeta("kind", openvdb::StringMetadata("delete"));
          }) == "grid 'seam.0001' has the kind 'delete'; known: remove, insert");
    CHECK(fault([](Volume&, auto& grids) { grids[1]->removeMeta("energy"); }) ==
          "grid 'seam.0001' has no number 'energy' in its metadata");
    CHECK(fault([](Volume& volume, auto&) { volume.grids[1] = openvdb::Int32Grid::create(); }) ==
          "the 3 grids must be float grids named 'seam.0000' to 'seam.0002', but there are "
          "seam.0000, , seam.0002");
}

TEST_CASE("a fault names the file, and a missing file is told before a run") {
    const Scratch scratch;
    Volume volume;
    volume.grids = {FloatGrid::create()};
    write_vdb(scratch / "other.vdb", volume);
    CHECK(failure_of([&] { read_seams(scratch / "other.vdb"); }) ==
          (scratch / "other.vdb") +
              ": the file has no text 'fluidcarve_axis' in its metadata, so it is no seam file");
    const NodeBench bench(seams_read(), "{path: " + (scratch / "none.vdb") + "}");
    CHECK(bench.survey({4, 5}).absent ==
          std::map<int, std::string>{{4, (scratch / "none.vdb") + " does not exist"}});
    CHECK(NodeBench(seams_read(), "{path: seams.####.vdb}").faults() ==
          "path: parameter 'path' can't have a frame token: one file holds the seams of all "
          "frames\n");
}

TEST_CASE("seams.write and seams.read pass seams through a file") {
    const Scratch scratch;
    const auto seams = std::make_shared<Seams>(some_seams());
    const auto yaml = "{path: " + (scratch / "seams.vdb") + "}";
    NodeBench(seams_write(), yaml).run({{"seams", {Payload(seams)}}});
    CHECK(equal(*NodeBench(seams_read(), yaml).run({}).at("seams").as<Seams>(), *seams));
}

TEST_CASE(
    "a shape or frames that the grids do not hold are refused before there is room made for them") {
    const auto no_numbers = [](const std::string& text) {
        return "'fluidcarve_shape' must be four numbers from 1 to 65535, I,J,K,T, not '" + text +
               "'";
    };
    // The second is 7,5,4,3 to readers that keep 32 bits.
    for (const std::string text :
         {"2147483648,5,4,3", "4294967303,5,4,3", "7,5,4,-3", "7,5,4,0", "1e3,5,4,3"})
        CHECK(metadata_fault("fluidcarve_shape", text) == no_numbers(text));
    CHECK(metadata_fault("fluidcarve_shape", std::string(1000, '7')) ==
          no_numbers(std::string(60, '7') + "..."));
    CHECK(
        metadata_fault("fluidcarve_shape", "65535,65535,65535,3") ==
        "grid 'seam.0000' has 60 active voxels, but must have one for each of 12884508675 columns");
    CHECK(metadata_fault("fluidcarve_shape", "7,4,5,3") ==
          "grid 'seam.0000' has active voxels from (0, 0, 0) to (4, 3, 2), but must have the "
          "columns from (0, 0, 0) to (3, 4, 2)");
    CHECK(metadata_fault("fluidcarve_frames", "1-99999999") ==
          "'fluidcarve_frames' '1-99999999' names more than 9 frames");
    CHECK(metadata_fault("fluidcarve_frames", "1-10") ==
          "'fluidcarve_frames' '1-10' names more than 9 frames");
    CHECK(metadata_fault("fluidcarve_window", "0,4294967297") ==
          "'fluidcarve_window' must be two vertices from 0 to 6, first,last, not '0,4294967297'");
    CHECK(
        metadata_fault("fluidcarve_anchor", "4294967296") ==
        "'fluidcarve_anchor' must be low, middle, high or a vertex from 0 to 6, not '4294967296'");
}

TEST_CASE("a file without grids takes no memory, whatever it states") {
    auto seams = straight({65535, 65535, 65535}, {1, 2, 3}, 0);
    seams.anchor = {Anchor::At::vertex, 7};
    const auto back = seams_from_volume(seams_to_volume(seams));
    CHECK(equal(back, seams));
    CHECK(back.shifts == std::vector<int>{0});
}

TEST_CASE(
    "columns in tiles and in shared trees are read, but not more than the file's size is good "
    "for") {
    std::vector<int> frames;
    for (int n = 1; n <= 16; ++n) frames.push_back(n);
    const auto two = straight({7, 16, 16}, frames, 2);
    auto volume = seams_to_volume(two);
    const auto tiles = openvdb::GridBase::grid<FloatGrid>(volume.grids[0]->deepCopyGrid());
    tiles->pruneGrid();
    REQUIRE(tiles->tree().leafCount() == 0);
    const auto same = tiles->copy();
    same->setName("seam.0001");
    volume.grids = {tiles, same};
    CHECK(equal(seams_from_volume(volume), two));
    const Scratch scratch;
    write_vdb(scratch / "seams.vdb", volume);
    CHECK(equal(read_seams(scratch / "seams.vdb"), two));

    // Each removal leaves one entry less: the first seam may have what the second may not.
    const auto high = openvdb::GridBase::grid<FloatGrid>(tiles->deepCopyGrid());
    high->tree().setValueOn(Coord(1, 2, 3), 6);
    const auto high_again = high->copy();
    high_again->setName("seam.0001");
    volume.grids = {high, high_again};
    CHECK(failure_of([&] { seams_from_volume(volume); }) ==
          "grid 'seam.0001' has 6 at (1, 2, 3), but must have a whole number from 0 to 5");

    volume.grids.clear();
    for (int n = 0; n < 9000; ++n) {
        volume.grids.push_back(tiles->copyGrid());
        std::const_pointer_cast<openvdb::GridBase>(volume.grids.back().grid())
            ->setName(fmt::format("seam.{:04}", n));
    }
    restate(volume, "fluidcarve_shape", "65535,16,16,16");
    CHECK(failure_of([&] {
              seams_from_volume(volume);
          }).find("the shape states 4096 columns, but the grids hold them in tiles") == 0);

    const auto one_tile = FloatGrid::create();
    one_tile->tree().addTile(3, Coord(0), 1, true);
    one_tile->setName("seam.0000");
    one_tile->insertMeta("kind", openvdb::StringMetadata("remove"));
    one_tile->insertMeta("energy", openvdb::DoubleMetadata(1));
    volume.grids = {one_tile};
    restate(volume, "fluidcarve_shape", "7,4096,4096,4096");
    restate(volume, "fluidcarve_frames", "1-4096");
    CHECK(failure_of([&] {
              seams_from_volume(volume);
          }).find("the shape states 68719476736 columns, but the grids hold them in tiles") == 0);
}

TEST_CASE(
    "grids that are missing, doubled, too many or of another type are refused, and so are numbers "
    "that are none") {
    CHECK(fault([](Volume& volume, auto&) { volume.grids.erase(volume.grids.begin()); }) ==
          "there is no grid 'seam.0000' among seam.0001, seam.0002");
    CHECK(fault([](Volume& volume, auto&) { volume.grids.erase(volume.grids.begin() + 1); }) ==
          "the 2 grids must be float grids named 'seam.0000' to 'seam.0001', but there are "
          "seam.0000, seam.0002");
    CHECK(fault([](Volume&, auto& grids) { grids[1]->setName("seam.0000"); }) ==
          "the 3 grids must be float grids named 'seam.0000' to 'seam.0002', but there are "
          "seam.0000, seam.0000, seam.0002");
    CHECK(fault([](Volume& volume, auto&) {
              for (int n = 0; n < 20; ++n) volume.grids.push_back(FloatGrid::create());
          }).ends_with(" and 11 more"));
    CHECK(fault([](Volume& volume, auto& grids) {
              for (std::size_t n = 3; n < 8; ++n) {
                  volume.grids.push_back(grids[0]->copy());
                  std::const_pointer_cast<openvdb::GridBase>(volume.grids.back().grid())
                      ->setName(fmt::format("seam.{:04}", n));
              }
          }) == "8 seams do not fit 7 vertices");
    const auto other_type = [](const openvdb::GridBase::Ptr& grid) {
        grid->setName("seam.0001");
        return fault([&](Volume& volume, auto&) { volume.grids[1] = grid; });
    };
    for (const auto& grid : std::initializer_list<openvdb::GridBase::Ptr>{
             openvdb::Int32Grid::create(), openvdb::DoubleGrid::create(),
             openvdb::BoolGrid::create(), openvdb::Vec3SGrid::create()})
        CHECK(other_type(grid).find("the 3 grids must be float grids") == 0);
    for (const float value :
         {1e30f, -1e30f, std::numeric_limits<float>::infinity(), 0.5f, 65536.0f})
        CHECK(fault([&](Volume&, auto& grids) {
                  grids[0]->tree().setValueOn(Coord(4, 0, 2), value);
              }).find("but must have a whole number from 0 to 6") != std::string::npos);
    CHECK(fault([](Volume&, auto& grids) {
              grids[1]->insertMeta("energy", openvdb::DoubleMetadata(NAN));
          }) == "grid 'seam.0001' has the energy nan, which is not finite");
}

TEST_CASE("seams that were changed without their checksum are refused, and read without one") {
    CHECK(fault([](Volume&, auto&) {}).empty());
    const auto another = [](Volume&, auto& grids) {
        auto& tree = grids[1]->tree();
        tree.setValueOn(Coord(4, 0, 2), tree.getValue(Coord(4, 0, 2)) == 0 ? 1 : 0);
    };
    CHECK(fault(another) == changed);
    CHECK(fault([](Volume&, auto& grids) {
              grids[1]->insertMeta("energy", openvdb::DoubleMetadata(1));
          }) == changed);
    CHECK(metadata_fault("fluidcarve_lattice_hash", "0123456789abcdef") == changed);
    CHECK(metadata_fault("fluidcarve_frames", "12-16x2") == changed);
    CHECK(metadata_fault("fluidcarve_closed", "true") == changed);
    CHECK(metadata_fault("fluidcarve_anchor", "high") == changed);
    CHECK(metadata_fault("fluidcarve_checksum", "md5:0123") == changed);
    CHECK(fault([&](Volume& volume, auto& grids) {
              another(volume, grids);
              restate(volume, "fluidcarve_checksum", "");
          }).empty());
    // What states the same in other words is the same.
    CHECK(metadata_fault("fluidcarve_closed", "false").empty());
    CHECK(metadata_fault("fluidcarve_shape", "7, 5, 4, 3").empty());
    CHECK(metadata_fault("fluidcarve_frames", "11,13,15").empty());
}

TEST_CASE(
    "a seam file that is written again with another codec is read, and so is one without a "
    "checksum") {
    const Scratch scratch;
    const auto seams = some_pairs(Axis::u, Seams::Kind::insert);
    auto volume = seams_to_volume(seams);
    for (const auto codec : {Codec::none, Codec::zip, Codec::blosc}) {
        write_vdb(scratch / "seams.vdb", volume, codec);
        CHECK(equal(read_seams(scratch / "seams.vdb"), seams));
    }
    restate(volume, "fluidcarve_checksum", "");
    write_vdb(scratch / "seams.vdb", volume);
    CHECK(equal(read_seams(scratch / "seams.vdb"), seams));
}

TEST_CASE("a seam file with random faults is refused, or gives the same seams") {
    const Scratch scratch;
    std::mt19937 random(11);
    auto seams = some_pairs(Axis::u, Seams::Kind::remove);
    seams.window = Window{0, 4};
    seams.closed = true;
    for (const auto codec : {Codec::none, Codec::blosc}) {
        write_vdb(scratch / "seams.vdb", seams_to_volume(seams), codec);
        const auto whole = Scratch::read(scratch / "seams.vdb");
        for (int n = 0; n < 150; ++n) {
            auto mutant = whole;
            for (auto faults = 1 + random() % 3; faults > 0; --faults) {
                // Half of the faults at the front, where the metadata is.
                const auto at =
                    random() % (random() % 2 ? std::min<std::size_t>(mutant.size() - 8, 1200)
                                             : mutant.size() - 8);
                const std::uint64_t number =
                    random() % 2 ? random() : ~std::uint64_t{0} << (random() % 64);
                if (random() % 2) mutant[at] = static_cast<char>(mutant[at] ^ (1 << random() % 8));
                else std::memcpy(mutant.data() + at, &number, 1 + random() % 8);
            }
            INFO("mutant " << n);
            const auto read = read_or_refused(scratch.write("mutant.vdb", mutant));
            // What no longer states a checksum is read as it is.
            CHECK((!read || equal(*read, seams) ||
                   mutant.find("fluidcarve_checksum") == std::string::npos));
        }
    }
}
