#include "tools/provenance/read_provenance.h"

#include "formats/file/module.h"
#include "formats/geometry_file/usda.h"
#include "formats/image/image_provenance.h"
#include "formats/image/image_volume.h"
#include "formats/mesh_file/mesh_file.h"
#include "formats/points_file/points_file.h"
#include "formats/vdb/provenance_metadata.h"
#include "formats/vdb/vdb_file.h"
#include "nodes/preview/canvas.h"
#include "tests/support/files/mesh_files.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>

using namespace fluidcarve;
using test::failure_of;

namespace {

const Provenance first{
    {"fluidcarve_version", "0.1.0"},
    {"fluidcarve_pipeline", "p.yaml"},
    {"fluidcarve_values", "{fluidcarve: 1, nodes: {a: {type: x, path: in.####.vdb}}}"},
    {"fluidcarve_command", "fluidcarve run p.yaml --set 'a.b=[1, 2]'"}};
const Provenance second{{"fluidcarve_version", "0.1.0"},
                        {"fluidcarve_seams", "seams=xxh3-128:0"},
                        {"fluidcarve_command", "fluidcarve run q.yaml"}};

const std::string triangle = "# a hand\no far\nv 0 0 0\nv 0 1 0\nv 0 0 1.25\nf 1 2 3\n";
const std::string dust =
    "ply\nformat ascii 1.0\ncomment dust\nelement vertex 1\nproperty float x\nproperty float "
    "y\nproperty float z\nend_header\n1 2 3\n";

}  // namespace

TEST_CASE(
    "a VDB file states its provenance as metadata of the file, in place of an older one, and no "
    "grid changes") {
    const Scratch scratch;
    Volume volume;
    const auto grid = FloatGrid::create();
    grid->setName("density");
    grid->tree().setValue({1, 2, 3}, 4);
    volume.grids.push_back(grid);
    volume.metadata.insertMeta("shot", openvdb::StringMetadata("sh010"));
    const auto path = scratch / "a.vdb";
    for (const auto& provenance : {first, second, Provenance{}}) {
        set_provenance(volume.metadata, provenance);
        write_vdb(path, volume);
        CHECK(read_provenance(path) == provenance);
        volume = read_vdb(path);
        CHECK(volume.metadata.getMetadata<openvdb::StringMetadata>("shot")->value() == "sh010");
        CHECK(volume.metadata.metaCount() == 1 + provenance.size());
        REQUIRE(volume.grids.size() == 1);
        for (const auto name : provenance_names)
            CHECK_FALSE((*volume.grids[0].grid())[std::string(name)]);
    }
}

TEST_CASE("meshes state it as comments, in place of older ones, and read as before") {
    const Scratch scratch;
    const auto in = scratch.write("in.obj", triangle), out = scratch / "out.obj";
    write_mesh(out, read_mesh(in).mesh, nullptr, first);
    CHECK(read_provenance(out) == first);
    CHECK(Scratch::read(out).starts_with(
        "# fluidcarve_version: 0.1.0\n# fluidcarve_pipeline: p.yaml\n"));
    CHECK(Scratch::read(out).ends_with(triangle));
    write_mesh(out, read_mesh(out).mesh, nullptr, second);
    CHECK(read_provenance(out) == second);
    write_mesh(out, read_mesh(out).mesh);
    CHECK(Scratch::read(out) == triangle);

    for (const auto* const format : {"ascii", "binary_big_endian"}) {
        const auto text = test::ply_of(format, true);
        const auto ply = scratch.write("in.ply", text), copy = scratch / "copy.ply",
                   plain = scratch / "plain.ply";
        write_mesh(plain, read_mesh(ply).mesh);
        write_mesh(copy, read_mesh(ply).mesh, nullptr, first);
        CHECK(read_provenance(copy) == first);
        const auto read = read_mesh(copy);
        CHECK(read.losses == read_mesh(ply).losses);
        write_mesh(copy, read.mesh);
        CHECK((Scratch::read(copy) == Scratch::read(plain)));
    }
    // Their formats have no place for it.
    for (const std::string name : {"out.off", "out.stl"}) {
        write_mesh(scratch / name, read_mesh(in).mesh, nullptr, first);
        const auto stated = Scratch::read(scratch / name);
        write_mesh(scratch / name, read_mesh(in).mesh);
        CHECK((Scratch::read(scratch / name) == stated));
    }
}

TEST_CASE("points state it as comments of PLY or metadata of VDB, in place of older ones") {
    const Scratch scratch;
    const auto in = scratch.write("in.ply", dust), ply = scratch / "out.ply",
               vdb = scratch / "out.vdb";
    const auto points = read_points(in, "", PointOffset::none, {});
    write_points(ply, points, nullptr, nullptr, nullptr, first);
    CHECK(read_provenance(ply) == first);
    const auto again = read_points(ply, "", PointOffset::none, {});
    write_points(ply, again, nullptr, nullptr, nullptr, second);
    CHECK(read_provenance(ply) == second);
    write_points(ply, again, nullptr, nullptr, nullptr);
    CHECK(Scratch::read(ply) == dust);

    Volume beside;
    set_provenance(beside.metadata, first);
    write_points(vdb, points, &beside, nullptr, nullptr, second);
    CHECK(read_provenance(vdb) == second);
}

TEST_CASE("pictures state it as texts that other readers take, and keep every pixel") {
    const Scratch scratch;
    const auto& images = load_module<ImageModule>("images");
    const auto sheet = scratch / "sheet.png";
    Canvas(8, 4, {1, 2, 3}).write_png(sheet, first);
    CHECK(read_provenance(sheet) == first);
    const auto read = images.read(sheet, "png");
    CHECK(read.data.width == 8);
    for (const auto& [name, text] : first) {
        const auto found = std::ranges::find(read.attributes, name, &Image::Attribute::name);
        REQUIRE(found != read.attributes.end());
        CHECK(found->value == text);
    }
    // It is of that file alone: a volume made of the picture does not say it.
    const auto volume = volume_of(read);
    CHECK(std::none_of(
        volume.metadata.beginMeta(), volume.metadata.endMeta(),
        [](const auto& each) { return each.first.find("fluidcarve") != std::string::npos; }));

    const auto jpeg = scratch / "rocket.jpg";
    std::filesystem::copy_file(TEST_DATA "/images/rocket.jpg", jpeg);
    const auto before = images.read(jpeg, "jpeg");
    CHECK(read_provenance(jpeg).empty());
    add_provenance(jpeg, second);
    CHECK(read_provenance(jpeg) == second);
    const auto after = images.read(jpeg, "jpeg");
    CHECK((after.pixels == before.pixels));
    CHECK(after.attributes.size() == before.attributes.size());
}

TEST_CASE("EXR files state it in their header") {
    const Scratch scratch;
    const auto& images = load_module<ImageModule>("images");
    Image image;
    image.format = "openexr";
    image.data = image.display = {0, 0, 2, 1};
    image.channels = {{"R", "half"}};
    image.pixels = {0.25f, 0.5f};
    const auto path = scratch / "a.exr";
    images.write(path, image, 95);
    CHECK(read_provenance(path).empty());
    for (const auto& [name, text] : second) image.attributes.push_back({name, "string", text});
    images.write(path, image, 95);
    auto found = read_provenance(path);
    // A header is sorted by name.
    std::ranges::sort(found);
    auto wanted = second;
    std::ranges::sort(wanted);
    CHECK(found == wanted);
    CHECK((images.read(path, "openexr").pixels == image.pixels));
}

TEST_CASE("files that state nothing, are damaged or of another kind are told from each other") {
    const Scratch scratch;
    const auto told = [&](const std::string& name, const std::string& bytes) {
        const auto path = scratch.write(name, bytes);
        auto out = failure_of([&] {
            if (!read_provenance(path).empty()) throw Failure("it states something");
        });
        for (std::size_t at; (at = out.find(scratch.path() + "/")) != std::string::npos;)
            out.erase(at, scratch.path().size() + 1);
        return out;
    };
    CHECK(told("a.obj", triangle) == "");
    CHECK(told("a.ply", dust) == "");
    // Behind the head of a file, a comment is anybody's.
    CHECK(told("b.obj", "v 0 0 0\n# fluidcarve_version: 9\n") == "");
    CHECK(told("b.ply", dust + "comment fluidcarve_version: 9\n") == "");
    CHECK(told("c.obj", "# fluidcarve_elsewhere: 9\n# fluidcarve_version:9\n") == "");
    CHECK(told("a.txt", "fluidcarve_version: 9\n") ==
          "a.txt is no file that states what made it; those are VDB, PNG, JPEG, EXR, PLY, OBJ and "
          "USDA "
          "files");
    CHECK(told("a.png", std::string("\x89PNG\r\n\x1a\n\0\0\xff\xffIHDR", 16)) ==
          "a.png is cut off or damaged at byte 16; copy or write it again");
    CHECK(told("b.png", "\x89PNG\r\n\x1a\n") ==
          "b.png is cut off or damaged at byte 8; copy or write it again");
    CHECK(told("a.jpg", std::string("\xff\xd8\xff\xe0\0\1", 6)) ==
          "a.jpg is cut off or damaged at byte 6; copy or write it again");
    CHECK(
        told("a.exr", std::string("\x76\x2f\x31\x01\2\0\0\0name\0string\0\xff\xff\xff\x7f", 24)) ==
        "a.exr is cut off or damaged at byte 24; copy or write it again");
    CHECK(told("b.exr", "\x76\x2f\x31\x01\2\1\1\1" + std::string(1000, 'n')) ==
          "b.exr is cut off or damaged at byte 265; copy or write it again");
    CHECK_THAT(told("a.vdb", " BDV" + std::string(4, '\0')), Catch::Contains("a.vdb"));
    CHECK(failure_of([&] { read_provenance(scratch / "none.vdb"); }) ==
          (scratch / "none.vdb") + " does not exist");
}

TEST_CASE("a USD file states its provenance in comments behind its first line") {
    const Scratch scratch;
    const auto path = scratch / "a.usda";
    const std::string text = "#usda 1.0\n(\n)\n\n# a hand\n";
    write_usda(path, text, first);
    CHECK(read_provenance(path) == first);
    const auto written = Scratch::read(path);
    CHECK(written.starts_with("#usda 1.0\n# fluidcarve_version: 0.1.0\n"));
    CHECK(written.ends_with("\n(\n)\n\n# a hand\n"));
    write_usda(path, text, {});
    CHECK(Scratch::read(path) == text);
}
