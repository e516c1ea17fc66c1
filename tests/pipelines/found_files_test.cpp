#include "formats/file/module.h"
#include "formats/image/image.h"
#include "formats/vdb/vdb_file.h"
#include "tests/support/program.h"
#include "tests/support/sampled.h"
#include "tests/support/vdb_grid.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace fluidcarve;
using openvdb::Vec3d;

namespace {

/// A ball of smoke with ripples, in 40 x 30 x 30 voxels of 0.1 from a place on.
FloatGrid::Ptr ball_of_smoke(const std::string& name, const Vec3d& from = Vec3d(0)) {
    const auto out = FloatGrid::create();
    out->setName(name);
    out->setGridClass(openvdb::GRID_FOG_VOLUME);
    out->setTransform(openvdb::math::Transform::createLinearTransform(0.1));
    out->transform().postTranslate(from);
    for (int x = 0; x < 40; ++x)
        for (int y = 0; y < 30; ++y)
            for (int z = 0; z < 30; ++z) {
                const Vec3d at((x - 19.5) / 9, (y - 14.5) / 7, (z - 14.5) / 7);
                const double value =
                    std::exp(-at.lengthSqr()) * (1 + 0.3 * std::sin(x) * std::cos(0.9 * y));
                if (value > 0.05) out->tree().setValue({x, y, z}, static_cast<float>(value));
            }
    return out;
}

Volume volume_of(std::vector<openvdb::GridBase::ConstPtr> grids) {
    Volume out;
    out.grids.assign(grids.begin(), grids.end());
    return out;
}

}  // namespace

TEST_CASE(
    "grids of one name, and a grid without a name, are carved and shown, all of one name move "
    "alike, and it says so") {
    const Scratch scratch;
    write_vdb(scratch / "two.vdb",
              volume_of({ball_of_smoke("density"), ball_of_smoke("density", {9, 0, 0})}));
    write_vdb(scratch / "none.vdb", volume_of({ball_of_smoke("")}));
    const auto in = "cd " + scratch.path() + " && ";
    const auto two = call_shell(in + FLUIDCARVE_PROGRAM
                                " carve two.vdb -4 -o o.vdb --sheet s.png --progress none");
    CHECK(two.code == 0);
    CHECK_THAT(two.err,
               Catch::StartsWith("warning: sim (vdb.read): there are several grids 'density': "
                                 "energies see 'density[0]', and all are carved by the same "
                                 "seams\ncarved: density[0] "));
    CHECK_THAT(two.err, Catch::Contains("\ncarved: density[1] "));
    const auto before = read_vdb(scratch / "two.vdb"), after = read_vdb(scratch / "o.vdb");
    REQUIRE(after.grids.size() == 2);
    for (std::size_t n = 0; n < 2; ++n)
        CHECK(after.grids[n]->evalActiveVoxelBoundingBox() !=
              before.grids[n]->evalActiveVoxelBoundingBox());
    for (const std::string name : {"two", "none"}) {
        INFO(name);
        const auto drafted =
            call_shell(in + FLUIDCARVE_PROGRAM " init " + name + ".vdb -o " + name +
                       ".yaml && " FLUIDCARVE_PROGRAM " run " + name + ".yaml --progress none");
        INFO(drafted.err);
        CHECK(drafted.code == 0);
    }
}

TEST_CASE(
    "a frame without the grid is named, whether the grid has another name there or the file is "
    "empty") {
    const Scratch scratch;
    for (int frame = 1; frame <= 4; ++frame) {
        const auto ball = ball_of_smoke(frame == 3 ? "heat" : "density");
        write_vdb(scratch / fmt::format("a.{:04}.vdb", frame), volume_of({ball}));
        write_vdb(scratch / fmt::format("e.{:04}.vdb", frame),
                  frame == 2 ? Volume() : volume_of({ball_of_smoke("density")}));
    }
    const auto in = "cd " + scratch.path() + " && ";
    const auto other = call_shell(in + FLUIDCARVE_PROGRAM " carve a.####.vdb -5 -o o.####.vdb");
    CHECK(other.err == "a.0003.vdb has no grid 'density', which a.0001.vdb has; it has heat\n");
    CHECK(other.code == 3);
    const auto empty = call_shell(in + FLUIDCARVE_PROGRAM " carve e.####.vdb -5 -o o.####.vdb");
    CHECK(empty.err == "e.0002.vdb has no grid 'density', which e.0001.vdb has; it has none\n");
    CHECK(empty.code == 3);
}

TEST_CASE("values of any size are carved: a solver sees them from 0 to 1") {
    const Scratch scratch;
    for (const double scale : {1e-6, 1e6, 1e30}) {
        INFO(scale);
        const auto ball = ball_of_smoke("density");
        for (auto value = ball->beginValueOn(); value; ++value)
            value.setValue(static_cast<float>(*value * scale));
        write_vdb(scratch / "a.vdb", volume_of({ball}));
        const auto ran = fluidcarve_program("carve " + (scratch / "a.vdb") +
                                            " -5 --progress none -o " + (scratch / "o.vdb"));
        INFO(ran.err);
        CHECK(ran.code == 0);
    }
}

TEST_CASE("a file of another format is called by its name, with what makes one to carve of it") {
    const Scratch scratch;
    const auto in = "cd " + scratch.path() + " && ";
    const auto said = [&](const std::string& command) {
        return call_shell(in + FLUIDCARVE_PROGRAM " " + command).err;
    };
    scratch.write("n.vdb", "NanoVDB0" + std::string(200, 0));
    scratch.write("n.nvdb", "NanoVDB0" + std::string(200, 0));
    scratch.write("n.xyz", "1 2 3");
    scratch.write("u.obj", std::string("\xff\xfev\0 \0", 6));
    scratch.write("c.csv", "1,2,3");
    CHECK(said("carve n.vdb -5 -o o.vdb") ==
          "n.vdb is a NanoVDB file, which can't be read: convert it with nanovdb_convert, or write "
          "it as OpenVDB\n");
    CHECK(said("carve n.nvdb -5 -o o.vdb") ==
          "n.nvdb is a NanoVDB file: convert it with nanovdb_convert, or write it as OpenVDB\n");
    CHECK(said("carve n.xyz -5 -o o.vdb") ==
          "n.xyz: files to carve end in .exr, .jpeg, .jpg, .obj, .off, .ply, .png, .stl, .tif, "
          ".tiff, .vdb\n");
    CHECK(said("carve c.csv -5 -o o.vdb") ==
          "c.csv is a curve, which holds nothing to carve; rig.curve reads it as a rig\n");
    CHECK(said("inspect u.obj") == "failed: u.obj: the text is in UTF-16: save it in UTF-8\n");
    scratch.write("m.off", "OFF3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    CHECK_THAT(call_shell(in + FLUIDCARVE_PROGRAM " inspect m.off").out,
               Catch::Contains("a mesh of 3 vertices and 1 faces"));
}

TEST_CASE("a picture of an object before black gets narrower by its background") {
    Image image;
    image.format = "openexr";
    image.data = image.display = {0, 0, 400, 200};
    image.channels = {{"R", "float"}, {"G", "float"}, {"B", "float"}};
    for (int y = 0; y < 200; ++y)
        for (int x = 0; x < 400; ++x) {
            const double distance = std::hypot(x - 200, y - 100) / 90,
                         light = distance < 1 ? 0.2 + 0.6 * std::sqrt(1 - distance * distance) : 0;
            for (const double colour : {1.0, 0.9, 0.8})
                image.pixels.push_back(static_cast<float>(colour * light * (x < 200 ? 0.5 : 1)));
        }
    const Scratch scratch;
    const auto& images = load_module<ImageModule>("images");
    images.write(scratch / "a.exr", image, 95);
    REQUIRE(fluidcarve_program("carve " + (scratch / "a.exr") + " -10% --progress none -o " +
                               (scratch / "b.exr"))
                .code == 0);
    const auto after = images.read(scratch / "b.exr", "openexr");
    CHECK(after.data.width == 360);
    const auto lit = [](const Image& of) {
        return std::ranges::count_if(of.pixels, [](float value) { return value > 0; });
    };
    // Even scaling takes a tenth.
    CHECK(static_cast<double>(lit(after)) > 0.95 * static_cast<double>(lit(image)));
}

TEST_CASE(
    "a plume that is made shorter keeps its foot on the floor, and one that does not is warned "
    "of") {
    const Scratch scratch;
    const auto carve = [&](const std::string& more) {
        return fluidcarve_program("carve tests/data/plume/plume.####.vdb -30% --axis z -o " +
                                  (scratch / "o.####.vdb") + " --progress none" + more);
    };
    const auto by_itself = carve("");
    CHECK(by_itself.code == 0);
    CHECK(by_itself.err.find("warning") == std::string::npos);
    const auto low = [](const std::string& file) {
        return read_vdb_grid(file, "density")->evalActiveVoxelBoundingBox().min().z();
    };
    CHECK(low(scratch / "o.0051.vdb") == low(SOURCE_ROOT "/tests/data/plume/plume.0051.vdb"));
    CHECK(carve(" --anchor low").err.find("warning") == std::string::npos);
    CHECK_THAT(carve(" --anchor middle").err,
               Catch::StartsWith("warning: carved (remap.grids): the end of density that stands "
                                 "still over the sequence, where its "
                                 "source is, moved by "));
}
