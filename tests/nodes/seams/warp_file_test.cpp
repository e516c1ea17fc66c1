#include "formats/seam_file/warp_file.h"
#include "formats/seam_file/seam_checksum.h"
#include "formats/seam_file/seam_file.h"
#include "formats/seam_file/seam_metadata.h"
#include "formats/vdb/vdb_file.h"
#include "nodes/payload/add_payloads.h"
#include "tests/support/files/edited_seams.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"
#include "tests/support/warped.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <sstream>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::Vec3d;

namespace {

double wave(int entry, int lateral, int k, int t) {
    return -0.3 * entry + std::sin(0.5 * lateral + k) + 0.1 * t;
}

Seams some_warp(int factor = 1, bool still = false, bool closed = false, Axis axis = Axis::u) {
    auto lattice = make_box(Vec3d(0), {9, 7, 6}, 0.5, {0, 1, 2});
    lattice.closed = closed;
    lattice.hash = lattice_hash(lattice);
    auto out = warped(lattice, wave, axis, {11, 13, 15}, factor, still);
    out.anchor = {Anchor::At::vertex, 3};
    return out;
}

bool equal_warps(const Seams& a, const Seams& b) {
    bool same = seam_texts(a) == seam_texts(b) && a.warp && b.warp &&
                a.warp->frames() == b.warp->frames() && a.warp->scale() == b.warp->scale() &&
                a.warp->bounds().value.least == b.warp->bounds().value.least &&
                a.shape_after(1) == b.shape_after(1);
    for (std::size_t t = 0; same && t < a.warp->frames(); ++t)
        same = std::ranges::equal(a.warp->values(t), b.warp->values(t));
    return same;
}

/// A warp's volume after `edit`, and what is said of it.
std::string fault_of_warp(const SeamEdit& edit, bool sum = true) {
    auto volume = seams_to_volume(some_warp());
    if (!sum) volume.metadata.removeMeta("fluidcarve_checksum");
    return fault_after(std::move(volume), edit);
}

PayloadType seams_payload() {
    Registry registry;
    add_seams_payload(registry);
    return registry.payload(typeid(Seams));
}

}  // namespace

TEST_CASE(
    "a warp comes back from its file as it was, of points apart, of a ring, and one that holds for "
    "all frames") {
    const Scratch scratch;
    for (const auto& seams : {some_warp(), some_warp(2), some_warp(4, true),
                              some_warp(2, false, true), some_warp(1, true, true, Axis::v)}) {
        write_seams(scratch / "warp.vdb", seams);
        CHECK(equal_warps(read_seams(scratch / "warp.vdb"), seams));
        CHECK(read_vdb(scratch / "warp.vdb").grids.size() == seams.warp->frames());
    }
    auto between = some_warp();
    between.window = Window{3, 5};
    between.pair_window = Window{6, 8};
    between.pair_below = Window{0, 2};
    write_seams(scratch / "between.vdb", between);
    CHECK(read_seams(scratch / "between.vdb").pair_below->last == 2);
    CHECK(equal_warps(read_seams(scratch / "between.vdb"), between));
    // What a file holds is what moves.
    auto scaled = some_warp();
    scaled.warp->set_scale(0.5);
    write_seams(scratch / "half.vdb", scaled);
    const auto back = read_seams(scratch / "half.vdb");
    CHECK(back.warp->scale() == 1);
    CHECK(back.warp->values(1)[5] == 0.5f * some_warp().warp->values(1)[5]);
    CHECK(seam_checksum(back) == seam_checksum(scaled));
    CHECK(seam_checksum(back) != seam_checksum(some_warp()));
}

TEST_CASE("a warp is kept as it is, with its scale, and damaged ones are refused") {
    const auto type = seams_payload();
    for (auto seams : {some_warp(2), some_warp(1, true)}) {
        seams.warp->set_scale(0.75);
        std::stringstream kept;
        type.write(Payload(std::make_shared<Seams>(seams)), kept);
        const auto text = kept.str();
        CHECK(equal_warps(*type.read(kept).as<Seams>(), seams));
        for (const std::size_t cut : {text.size() - 1, text.size() / 2, text.size() - 5}) {
            std::stringstream shorter(text.substr(0, cut));
            CHECK(failure_of([&] { type.read(shorter); }) == "kept data is damaged or cut off");
        }
    }
    auto folding = some_warp();
    folding.warp->set_scale(4);
    std::stringstream kept;
    type.write(Payload(std::make_shared<Seams>(folding)), kept);
    CHECK(failure_of([&] { type.read(kept); }) == "kept data is damaged or cut off");
    CHECK(type.bytes(Payload(std::make_shared<Seams>(some_warp()))) ==
          9 * 7 * 6 * 3 * sizeof(float));
}

TEST_CASE("a warp's file that is no whole warp is refused, and says why") {
    CHECK(fault_of_warp([](auto&, auto&) {}).empty());
    CHECK(fault_of_warp([](Volume& volume, auto&) {
              restate(volume, "fluidcarve_warp_factor", "3");
          }) == "'fluidcarve_warp_factor' must be 1, 2 or 4, not '3'");
    CHECK(fault_of_warp(
              [](Volume& volume, auto&) { restate(volume, "fluidcarve_warp_factor", "2"); }) ==
          "grid 'warp.0000' has 378 active voxels, but must have the 80 points from (0, 0, 0) to "
          "(4, 3, 3), by the shape and the factor");
    CHECK(fault_of_warp([](Volume& volume, auto&) {
              restate(volume, "fluidcarve_shape", "65535,65535,65535,3");
          }) ==
          "grid 'warp.0000' has 378 active voxels, but must have the 281462092005375 points from "
          "(0, 0, 0) to (65534, 65534, 65534), by the shape and the "
          "factor");
    CHECK(fault_of_warp([](Volume& volume, auto&) { volume.grids.pop_back(); }) ==
          "there are 2 grids, but a warp has one, or one for each of 3 frames");
    CHECK(fault_of_warp([](Volume&, auto& grids) { grids[1]->setName("other"); }) ==
          "there is no float grid 'warp.0001'; a warp of 3 grids has 'warp.0000' to 'warp.0002'");
    CHECK(fault_of_warp([](Volume&, auto& grids) {
              grids[2]->tree().setValueOff({3, 3, 3});
          }) ==
          "grid 'warp.0002' has 377 active voxels, but must have the 378 points from (0, 0, 0) to "
          "(8, 6, 5), by the shape and the factor");
    CHECK(fault_of_warp([](Volume&, auto& grids) {
              grids[1]->tree().setValueOn({3, 2, 1}, std::numeric_limits<float>::quiet_NaN());
          }) == "grid 'warp.0001' has nan at (3, 2, 1), which is not finite");
    const auto swapped = fault_of_warp([](Volume&, auto& grids) {
        grids[1]->tree().setValueOn({3, 2, 1}, 7);
    });
    CHECK(swapped.starts_with(
        "grid 'warp.0001' moves the point (3, 2, 1) by 7 vertices and the next along u by "));
    CHECK(swapped.ends_with(": they would change places"));
    CHECK(fault_of_warp(
              [](Volume&, auto& grids) {
                  for (auto value = grids[0]->beginValueOn(); value; ++value) value.setValue(1e30f);
              },
              false) != "");
    CHECK(fault_of_warp([](Volume&, auto& grids) {
              grids[1]->tree().setValueOn({8, 2, 1}, 0.5f);
          }) ==
          "the file is damaged or was changed: its content does not match its checksum; write it "
          "again, or remove the metadata 'fluidcarve_checksum' if you "
          "changed it on purpose");
    CHECK(fault_of_warp(
              [](Volume&, auto& grids) {
                  grids[1]->tree().setValueOn({8, 2, 1}, 0.5f);
              },
              false)
              .empty());
}

TEST_CASE("very many points in a few tiles are refused before memory is taken for them") {
    auto volume = seams_to_volume(some_warp(1, true));
    const auto grid = FloatGrid::create();
    grid->setName("warp.0000");
    grid->tree().addTile(2, Coord(0), 0.0f, true);
    grid->fill(openvdb::CoordBBox(Coord(0), Coord(4095, 4095, 1023)), 0.0f, true);
    volume.grids = {grid};
    restate(volume, "fluidcarve_shape", "4096,4096,1024,3");
    try {
        seams_from_volume(volume);
        FAIL("was read");
    } catch (const Failure& failure) {
        CHECK(std::string(failure.what())
                  .starts_with("the warp has 17179869184 points in each of 1 grids, but these hold "
                               "them in tiles or shared trees of "));
    }
}
