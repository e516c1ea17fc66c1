#include "formats/vdb/vdb_file.h"
#include "tests/support/failure_of.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/scratch.h"
#include "tests/support/vdb_grid.h"

#include <fmt/format.h>
#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>
#include <openvdb/points/PointAttribute.h>
#include <openvdb/points/PointConversion.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <catch2/catch.hpp>

#include <sys/resource.h>
#include <sys/stat.h>
#include <csignal>
#include <random>

using namespace fluidcarve;
using test::difference;
using test::failure_of;

namespace {

/// A little of all that OpenVDB files hold.
Volume oddities() {
    openvdb::initialize();
    Volume out;
    const auto put = [&](const openvdb::GridBase::Ptr& grid, const std::string& name) {
        grid->setName(name);
        out.grids.push_back(grid);
        return grid;
    };
    put(openvdb::tools::createLevelSetSphere<FloatGrid>(1.0f, openvdb::Vec3f(0.2f), 0.1f),
        "surface")
        ->setTransform(openvdb::math::Transform::createFrustumTransform({{0, 0, 0}, {9, 9, 9}}, 0.5,
                                                                        3.0, 0.1));
    put(FloatGrid::create(-0.0f), "empty");

    const auto tiles = FloatGrid::create(0.25f);
    tiles->tree().addTile(1, {8, 0, 0}, 3.0f, true);
    tiles->tree().addTile(2, {128, 0, 0}, 4.0f, false);
    tiles->tree().addTile(3, {-4096, 0, 0}, 5.0f, true);
    tiles->tree().touchLeaf({64, 64, 64});
    tiles->tree().setValueOff({64, 64, 65}, 7.0f);
    tiles->tree().setValueOff({64, 64, 66}, 8.0f);
    tiles->tree().setValueOff({64, 64, 67}, std::numeric_limits<float>::quiet_NaN());
    tiles->tree().setValueOn({64, 64, 68}, 0.25f);
    tiles->insertMeta("creator", openvdb::StringMetadata("a test"));
    tiles->insertMeta("shutter", openvdb::Vec3DMetadata({0.1, 0.2, 0.3}));
    tiles->setTransform(openvdb::math::Transform::createLinearTransform(
        openvdb::math::Mat4d(0., .1, 0., 0., -.1, 0., 0., 0., 0., 0., .2, 0., 3., 4., 5., 1.)));
    put(tiles, "density");
    put(tiles->copyGrid(), "density")->setGridClass(openvdb::GRID_FOG_VOLUME);
    put(openvdb::Int32Grid::create(-3), "");

    const auto half = VectorGrid::create(openvdb::Vec3s(1, 2, 3));
    half->setSaveFloatAsHalf(true);
    half->setGridClass(openvdb::GRID_STAGGERED);
    half->setVectorType(openvdb::VEC_CONTRAVARIANT_RELATIVE);
    half->tree().setValueOn({1, 2, 3}, openvdb::Vec3s(0.5f, -0.25f, 0));
    put(half, "velocity");
    put(openvdb::DoubleGrid::create(1e-300), "double");
    put(openvdb::MaskGrid::create(), "mask");
    put(openvdb::BoolGrid::create(true), "bool");

    const std::vector<openvdb::Vec3f> positions{
        {0.1f, 0.2f, 0.3f}, {-5, 2, 1}, {0.1f, 0.21f, 0.3f}};
    put(openvdb::points::createPointDataGrid<openvdb::points::NullCodec,
                                             openvdb::points::PointDataGrid>(
            positions, *openvdb::math::Transform::createLinearTransform(0.5)),
        "drops");
    out.metadata.insertMeta("project", openvdb::StringMetadata("fluidcarve"));
    return out;
}

void require_same_content(const Volume& a, const Volume& b) {
    REQUIRE(a.names() == b.names());
    for (std::size_t n = 0; n < a.grids.size(); ++n)
        CHECK(difference(*a.grids[n].grid(), *b.grids[n].grid()) == "");
    CHECK(test::kept_metadata(a.metadata) == test::kept_metadata(b.metadata));
}

std::vector<std::string> public_files() {
    const std::string data = TEST_DATA;
    return {data + "/vdb/cortex_points.vdb",        data + "/vdb/cortex_sphere.vdb",
            data + "/vdb/gaffer_arnold_sphere.vdb", data + "/vdb/oiio_sphere.vdb",
            data + "/vdb/oiio_sphereCd.vdb",        data + "/plume/plume.0051.vdb"};
}

}  // namespace

TEST_CASE("reading gives what OpenVDB's own reader gives, in the order of the file") {
    for (const auto& path : public_files()) {
        INFO(path);
        const auto volume = read_vdb(path);
        openvdb::io::File file(path);
        file.open(false);
        const auto header = read_vdb_header(path);
        REQUIRE(volume.grids.size() == file.getGrids()->size());
        REQUIRE(header.grids.size() == volume.grids.size());
        for (std::size_t n = 0; n < volume.grids.size(); ++n) {
            CHECK(difference(*volume.grids[n].grid(),
                             *file.readGrid(header.grids[n].unique_name)) == "");
            CHECK(difference(*volume.grids[n].grid(),
                             *read_vdb_grid(path, header.grids[n].unique_name)) == "");
        }
    }
    CHECK(read_vdb(public_files().back()).names() ==
          "velocity, density, shadow, temperature, flame");
}

TEST_CASE("one open file gives its header and its grids, one by one or all, in any order") {
    for (const auto& path : public_files()) {
        INFO(path);
        const auto volume = read_vdb(path);
        VdbFile file(path);
        for (std::size_t n = volume.grids.size(); n-- > 0;)
            CHECK(difference(*volume.grids[n].grid(), *file.read(n)) == "");
        CHECK(file.header().names() == read_vdb_header(path).names());
        require_same_content(volume, file.read());
    }
}

TEST_CASE("reading and writing keeps every grid bit for bit") {
    const Scratch scratch;
    for (const auto& path : public_files()) {
        INFO(path);
        const auto before = read_vdb(path);
        write_vdb(scratch / "out.vdb", before);
        const auto after = read_vdb(scratch / "out.vdb");
        require_same_content(before, after);
        CHECK(before.codec == after.codec);
    }
}

TEST_CASE(
    "odd grids survive every codec: tiles, NaN, frustums, points, equal names, shared trees") {
    const Scratch scratch;
    const auto before = oddities();
    const auto codec = GENERATE(Codec::as_read, Codec::blosc, Codec::zip, Codec::none);
    write_vdb(scratch / "new folder/out.vdb", before, codec);
    const auto after = read_vdb(scratch / "new folder/out.vdb");
    require_same_content(before, after);
    CHECK(after.codec == (codec == Codec::zip ? "zip" : codec == Codec::none ? "none" : "blosc"));
    CHECK(&after.grids[2]->constBaseTree() == &after.grids[3]->constBaseTree());
    CHECK(read_vdb_header(scratch / "new folder/out.vdb").names() ==
          std::vector<std::string>{"surface", "empty", "density[0]", "density[1]", "[0]",
                                   "velocity", "double", "mask", "bool", "drops"});
    CHECK(difference(*read_vdb_grid(scratch / "new folder/out.vdb", "density[1]"),
                     *before.grids[3].grid()) == "");
}

TEST_CASE("any number of points reads back") {
    const Scratch scratch;
    openvdb::initialize();
    for (int count = 1; count < 40; ++count) {
        std::vector<openvdb::Vec3f> positions;
        for (int n = 0; n < count; ++n)
            positions.emplace_back(0.1f * static_cast<float>(n % 3), 0.2f, 0.3f);
        using namespace openvdb::points;
        const auto grid = createPointDataGrid<NullCodec, PointDataGrid>(
            positions, *openvdb::math::Transform::createLinearTransform(0.5));
        grid->setName("drops");
        openvdb::io::File(scratch / "drops.vdb").write(openvdb::GridCPtrVec{grid});
        INFO(count);
        CHECK(difference(*read_vdb_grid(scratch / "drops.vdb", "drops"), *grid) == "");
    }
}

TEST_CASE("a file that was written as a stream reads as any other") {
    const Scratch scratch;
    const auto same_as = [&](const Volume& wanted, std::uint32_t flags) {
        {
            std::ofstream to(scratch / "stream.vdb", std::ios::binary);
            openvdb::io::Stream stream(to);
            stream.setCompression(flags);
            stream.write(wanted.grids, wanted.metadata);
        }
        require_same_content(wanted, read_vdb(scratch / "stream.vdb"));
        CHECK(read_vdb_header(scratch / "stream.vdb").names().size() == wanted.grids.size());
    };
    using namespace openvdb::io;
    for (const std::uint32_t flags : {+COMPRESS_NONE, +COMPRESS_ZIP, +COMPRESS_ACTIVE_MASK,
                                      COMPRESS_ACTIVE_MASK | COMPRESS_BLOSC}) {
        same_as(oddities(), flags);
        for (const auto& path : public_files()) same_as(read_vdb(path), flags);
    }
}

TEST_CASE("a stream with a wrong byte anywhere is read or refused") {
    const Scratch scratch;
    std::ostringstream to;
    openvdb::io::Stream(to).write(oddities().grids);
    const auto sound = to.str();
    std::mt19937 random(1);
    int refused = 0;
    for (int n = 0; n < 400; ++n) {
        auto bytes = sound;
        bytes[random() % bytes.size()] = static_cast<char>(random());
        scratch.write("stream.vdb", bytes);
        // Any other exception fails the test.
        if (!failure_of([&] { VdbFile(scratch / "stream.vdb", 100 << 20).read(); }).empty())
            ++refused;
    }
    CHECK(refused > 10);
}

TEST_CASE("a stream with a grid of an unknown type is refused, and says why") {
    const Scratch scratch;
    openvdb::initialize();
    auto grid = openvdb::points::PointDataGrid::create();
    grid->setName("drops");
    std::ostringstream to;
    openvdb::io::Stream(to).write(openvdb::GridCPtrVec{grid});
    auto text = to.str();
    const std::string type = "Tree_ptdataidx32_5_4_3";
    text.replace(text.find(type), type.size(), "Tree_pldataidx32_5_4_3");
    scratch.write("stream.vdb", text);
    CHECK(failure_of([&] { read_vdb_header(scratch / "stream.vdb"); }) ==
          scratch / "stream.vdb" +
              " was written as a stream, where only the tree of a grid says where it ends, and "
              "grid 'drops' is of type Tree_pldataidx32_5_4_3, which OpenVDB " +
              openvdb::getLibraryVersionString() +
              " does not know: write the file with openvdb::io::File");
}

TEST_CASE("a codec that was read is written again") {
    const Scratch scratch;
    auto volume = oddities();
    volume.codec = "zip";
    write_vdb(scratch / "zip.vdb", volume);
    CHECK(read_vdb(scratch / "zip.vdb").codec == "zip");
}

TEST_CASE("the 16-bit integers of Blender's liquid caches are known") {
    const Scratch scratch;
    read_vdb_header(public_files()[0]);
    auto volume = oddities();
    const auto points = openvdb::gridPtrCast<openvdb::points::PointDataGrid>(
        openvdb::ConstPtrCast<openvdb::GridBase>(volume.grids.back().grid()));
    REQUIRE(points);
    openvdb::points::appendAttribute(points->tree(), "U", {"int32", "trnc"});
    write_vdb(scratch / "liquid.vdb", volume);
    require_same_content(volume, read_vdb(scratch / "liquid.vdb"));
}

TEST_CASE("a length that the file can't hold is not allocated") {
    const Scratch scratch;
    auto text = Scratch::read(std::string(TEST_DATA) + "/vdb/cortex_points.vdb");
    const auto name = text.find("points");
    REQUIRE(text.substr(name - 4, 4) == std::string("\6\0\0\0", 4));
    text.replace(name - 4, 4, "\xff\xff\xff\xff");
    scratch.write("long.vdb", text);
    rusage before{}, after{};
    getrusage(RUSAGE_SELF, &before);
    CHECK(failure_of([&] { read_vdb_header(scratch / "long.vdb"); }) ==
          scratch / "long.vdb" +
              " is cut off: it ends within its header, at byte 38933; copy or write it again");
    getrusage(RUSAGE_SELF, &after);
    CHECK(after.ru_maxrss - before.ru_maxrss < 100'000);
}

TEST_CASE("a half grid stays half even where only its type says so") {
    const Scratch scratch;
    Volume volume;
    const auto grid = FloatGrid::create();
    grid->setSaveFloatAsHalf(true);
    grid->setName("density");
    volume.grids.push_back(grid);
    write_vdb(scratch / "half.vdb", volume);
    auto text = Scratch::read(scratch / "half.vdb");
    const auto key = text.find(openvdb::GridBase::META_SAVE_HALF_FLOAT);
    REQUIRE(key != std::string::npos);
    text[key] = 'x';
    scratch.write("half.vdb", text);
    CHECK(read_vdb(scratch / "half.vdb").grids[0]->saveFloatAsHalf());
}

TEST_CASE("a file cut off anywhere is refused") {
    const Scratch scratch;
    write_vdb(scratch / "odd.vdb", oddities());
    std::ofstream stream(scratch / "stream.vdb", std::ios::binary);
    openvdb::io::Stream(stream).write(oddities().grids);
    stream.close();
    for (const auto& path : {std::string(TEST_DATA) + "/vdb/cortex_points.vdb",
                             std::string(TEST_DATA) + "/vdb/gaffer_arnold_sphere.vdb",
                             scratch / "odd.vdb", scratch / "stream.vdb"}) {
        std::filesystem::copy_file(path, scratch / "cut.vdb",
                                   std::filesystem::copy_options::overwrite_existing);
        std::vector<std::uint64_t> passed;
        for (auto size = std::filesystem::file_size(path), near_end = size - 64; size > 0;) {
            size -= size > near_end || size <= 4096 ? 1 : 97;
            std::filesystem::resize_file(scratch / "cut.vdb", size);
            if (failure_of([&] { read_vdb_header(scratch / "cut.vdb"); }).empty())
                passed.push_back(size);
        }
        INFO(path);
        CHECK(passed.empty());
    }
}
