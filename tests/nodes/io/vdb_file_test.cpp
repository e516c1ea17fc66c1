#include "nodes/io/vdb_file.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/scratch.h"

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
#include <cstring>
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
    put(openvdb::tools::createLevelSetSphere<FloatGrid>(1.0f, openvdb::Vec3f(0.2f), 0.1f), "surface")
        ->setTransform(openvdb::math::Transform::createFrustumTransform({{0, 0, 0}, {9, 9, 9}}, 0.5, 3.0, 0.1));
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
    tiles->setTransform(openvdb::math::Transform::createLinearTransform(openvdb::math::Mat4d(0., .1, 0., 0., -.1, 0., 0., 0., 0., 0., .2, 0., 3., 4., 5., 1.)));
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

    const std::vector<openvdb::Vec3f> positions{{0.1f, 0.2f, 0.3f}, {-5, 2, 1}, {0.1f, 0.21f, 0.3f}};
    put(openvdb::points::createPointDataGrid<openvdb::points::NullCodec, openvdb::points::PointDataGrid>(positions,
                                                                                                         *openvdb::math::Transform::createLinearTransform(0.5)),
        "drops");
    out.metadata.insertMeta("project", openvdb::StringMetadata("fluidcarve"));
    return out;
}

void require_same_content(const Volume& a, const Volume& b) {
    REQUIRE(a.names() == b.names());
    for (std::size_t n = 0; n < a.grids.size(); ++n) CHECK(difference(*a.grids[n].grid(), *b.grids[n].grid()) == "");
    CHECK(test::kept_metadata(a.metadata) == test::kept_metadata(b.metadata));
}

std::vector<std::string> public_files() {
    const std::string data = TEST_DATA;
    return {data + "/vdb/cortex_points.vdb", data + "/vdb/cortex_sphere.vdb", data + "/vdb/gaffer_arnold_sphere.vdb",
            data + "/vdb/oiio_sphere.vdb",   data + "/vdb/oiio_sphereCd.vdb", data + "/plume/plume.0051.vdb"};
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
            CHECK(difference(*volume.grids[n].grid(), *file.readGrid(header.grids[n].unique_name)) == "");
            CHECK(difference(*volume.grids[n].grid(), *read_vdb_grid(path, header.grids[n].unique_name)) == "");
        }
    }
    CHECK(read_vdb(public_files().back()).names() == "velocity, density, shadow, temperature, flame");
}

TEST_CASE("one open file gives its header and its grids, one by one or all, in any order") {
    for (const auto& path : public_files()) {
        INFO(path);
        const auto volume = read_vdb(path);
        VdbFile file(path);
        for (std::size_t n = volume.grids.size(); n-- > 0;) CHECK(difference(*volume.grids[n].grid(), *file.read(n)) == "");
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

TEST_CASE("odd grids survive every codec: tiles, NaN, frustums, points, equal names, shared trees") {
    const Scratch scratch;
    const auto before = oddities();
    const auto codec = GENERATE(Codec::as_read, Codec::blosc, Codec::zip, Codec::none);
    write_vdb(scratch / "new folder/out.vdb", before, codec);
    const auto after = read_vdb(scratch / "new folder/out.vdb");
    require_same_content(before, after);
    CHECK(after.codec == (codec == Codec::zip ? "zip" : codec == Codec::none ? "none" : "blosc"));
    CHECK(&after.grids[2]->constBaseTree() == &after.grids[3]->constBaseTree());
    CHECK(read_vdb_header(scratch / "new folder/out.vdb").names() ==
          std::vector<std::string>{"surface", "empty", "density[0]", "density[1]", "[0]", "velocity", "double", "mask", "bool", "drops"});
    CHECK(difference(*read_vdb_grid(scratch / "new folder/out.vdb", "density[1]"), *before.grids[3].grid()) == "");
}

TEST_CASE("any number of points reads back") {
    const Scratch scratch;
    openvdb::initialize();
    for (int count = 1; count < 40; ++count) {
        std::vector<openvdb::Vec3f> positions;
        for (int n = 0; n < count; ++n) positions.emplace_back(0.1f * static_cast<float>(n % 3), 0.2f, 0.3f);
        using namespace openvdb::points;
        const auto grid = createPointDataGrid<NullCodec, PointDataGrid>(positions, *openvdb::math::Transform::createLinearTransform(0.5));
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
    for (const std::uint32_t flags : {+COMPRESS_NONE, +COMPRESS_ZIP, +COMPRESS_ACTIVE_MASK, COMPRESS_ACTIVE_MASK | COMPRESS_BLOSC}) {
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
        if (!failure_of([&] { VdbFile(scratch / "stream.vdb", 100 << 20).read(); }).empty()) ++refused;
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
              " was written as a stream, where only the tree of a grid says where it ends, and grid 'drops' is of type Tree_pldataidx32_5_4_3, which OpenVDB " +
              openvdb::getLibraryVersionString() + " does not know: write the file with openvdb::io::File");
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
    const auto points = openvdb::gridPtrCast<openvdb::points::PointDataGrid>(openvdb::ConstPtrCast<openvdb::GridBase>(volume.grids.back().grid()));
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
          scratch / "long.vdb" + " is cut off: it ends within its header, at byte 38933; copy or write it again");
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
    for (const auto& path : {std::string(TEST_DATA) + "/vdb/cortex_points.vdb", std::string(TEST_DATA) + "/vdb/gaffer_arnold_sphere.vdb", scratch / "odd.vdb",
                             scratch / "stream.vdb"}) {
        std::filesystem::copy_file(path, scratch / "cut.vdb", std::filesystem::copy_options::overwrite_existing);
        std::vector<std::uint64_t> passed;
        for (auto size = std::filesystem::file_size(path), near_end = size - 64; size > 0;) {
            size -= size > near_end || size <= 4096 ? 1 : 97;
            std::filesystem::resize_file(scratch / "cut.vdb", size);
            if (failure_of([&] { read_vdb_header(scratch / "cut.vdb"); }).empty()) passed.push_back(size);
        }
        INFO(path);
        CHECK(passed.empty());
    }
}

TEST_CASE("a file cut off is an input's fault, and the message says where it ends") {
    const Scratch scratch;
    const auto whole = Scratch::read(std::string(TEST_DATA) + "/vdb/cortex_points.vdb");
    // The header ends where the only grid begins.
    constexpr std::size_t header = 0xbc;
    std::vector<std::size_t> sizes;
    for (std::size_t size = 0; size < 200; ++size) sizes.push_back(size);
    for (std::size_t n = 0; n < 60; ++n) sizes.push_back(200 + (whole.size() - 200) * n / 60);
    sizes.push_back(whole.size() - 1);
    const auto path = scratch / "cut.vdb";
    for (const auto size : sizes) {
        scratch.write("cut.vdb", whole.substr(0, size));
        const auto wanted =
            path + (size < header ? fmt::format(" is cut off: it ends within its header, at byte {}; copy or write it again", size)
                                  : fmt::format(" is cut off: grid 'points' ends at byte {}, the file at {}; copy or write it again", whole.size(), size));
        const std::function<void()> readers[] = {[&] { read_vdb_header(path); }, [&] { read_vdb(path); }, [&] { read_vdb_grid(path, "points"); }};
        for (const auto& read : readers) {
            std::string told;
            try {
                read();
            } catch (const Failure& failure) {
                told = failure.kind == Failure::Kind::input ? failure.what() : "not the input's fault";
            }
            CHECK(told == wanted);
        }
    }
}

TEST_CASE("what is wrong with a file is said in words") {
    const Scratch scratch;
    const auto whole = Scratch::read(std::string(TEST_DATA) + "/vdb/cortex_points.vdb");
    const auto refusal = [&](const std::string& name) { return failure_of([&] { read_vdb(scratch / name); }); };
    const auto is = [&](const std::string& name, const std::string& message) { CHECK(refusal(name) == scratch / name + message); };

    is("none.vdb", " does not exist");
    std::filesystem::create_directory(scratch / "folder.vdb");
    is("folder.vdb", " is not a file");
    REQUIRE(mkfifo((scratch / "pipe.vdb").c_str(), 0600) == 0);
    is("pipe.vdb", " is a pipe or a device; a volume is read from a regular file");
    scratch.write("text.vdb", "not a volume at all");
    is("text.vdb", " is not a VDB file");
    scratch.write("empty.vdb", "");
    is("empty.vdb", " is cut off: it ends within its header, at byte 0; copy or write it again");
    scratch.write("cut.vdb", whole.substr(0, 30000));
    is("cut.vdb", " is cut off: grid 'points' ends at byte 38933, the file at 30000; copy or write it again");

    auto changed = whole;
    const std::size_t positions = 0xa4;
    REQUIRE(whole.substr(positions, 8) == std::string("\xbc\0\0\0\0\0\0\0", 8));
    changed.replace(positions, 24, 24, '\0');
    scratch.write("unfinished.vdb", changed);
    is("unfinished.vdb", " is unfinished or damaged: it does not say where grid 'points' ends; wait for its writer, or write it again");
    changed = Scratch::read(std::string(TEST_DATA) + "/vdb/cortex_sphere.vdb");
    changed[changed.find("Tree_float")] = 'X';
    scratch.write("strange.vdb", changed);
    is("strange.vdb",
       ": grid 'ls_sphere' is of type Xree_float_5_4_3, which OpenVDB 10.0.1 does not know; it can be copied unchanged only from a file of version 224, but "
       "this one has 222: write the file without this grid");
    changed = whole;
    changed[8] = '\xff';
    scratch.write("newer.vdb", changed);
    is("newer.vdb", " has file version 255, and 225 is the newest that can be read: write it with an older OpenVDB");
    // What OpenVDB 13 writes.
    changed = Scratch::read(TEST_DATA "/plume/plume.0051.vdb");
    REQUIRE(changed[8] == '\xe0');
    changed[8] = '\xe1';
    scratch.write("of13.vdb", changed);
    CHECK(read_vdb_header(scratch / "of13.vdb").version == 225);
    CHECK(read_vdb(scratch / "of13.vdb").grids.size() == read_vdb(TEST_DATA "/plume/plume.0051.vdb").grids.size());

    const auto odd = FloatGrid::create();
    odd->setName("odd");
    odd->insertMeta("class", openvdb::Int32Metadata(3));
    openvdb::io::File(scratch / "class.vdb").write(openvdb::GridCPtrVec{odd});
    is("class.vdb", ": cannot read grid 'odd': its metadata 'class' has the type int32, but must have the type string; write or copy the file again");

    const auto path = std::string(TEST_DATA) + "/plume/plume.0051.vdb";
    CHECK(failure_of([&] { read_vdb_grid(path, "densty"); }) ==
          path + " has no grid 'densty'; it has velocity, density, shadow, temperature, flame; did you mean 'density'?");
    write_vdb(scratch / "bare.vdb", Volume{});
    CHECK(failure_of([&] { read_vdb_grid(scratch / "bare.vdb", "density"); }) == scratch / "bare.vdb" + " has no grid 'density'; it has none");
}

TEST_CASE("numbers in a header that make no sense are damage, and nothing is made room for") {
    const Scratch scratch;
    const auto whole = Scratch::read(std::string(TEST_DATA) + "/vdb/gaffer_arnold_sphere.vdb");
    const auto refusal = [&](std::size_t at, const std::string& bytes) {
        auto changed = whole;
        changed.replace(at, bytes.size(), bytes);
        scratch.write("bad.vdb", changed);
        return failure_of([&] { read_vdb_header(scratch / "bad.vdb"); });
    };
    const auto map = whole.find("UniformScaleTranslateMap");
    const auto statistic = whole.find("file_mem_bytes");
    REQUIRE(map != std::string::npos);
    REQUIRE(statistic != std::string::npos);
    CHECK(refusal(map + 24, std::string(8, '\xff')) == scratch / "bad.vdb" + " is damaged: the transform of grid 'density' is not finite");
    // The map's name is followed by a translation, three scales, the voxel's edges and the inverses of the scales.
    for (const auto& [nth, number] : {std::pair{3, 0.0}, {3, 5.0}, {7, 1e-3}, {8, -0.2}, {11, 1e9}}) {
        INFO("number " << nth << " is " << number);
        CHECK(refusal(map + 24 + 8 * static_cast<std::size_t>(nth), std::string(reinterpret_cast<const char*>(&number), sizeof number)) ==
              scratch / "bad.vdb" + " is damaged: the numbers of the transform of grid 'density' contradict each other; write or copy the file again");
    }
    // The entry's type, int64, follows its name; then comes its size, 8.
    const auto size = whole.find("int64", statistic) + 5;
    CHECK(refusal(size, std::string("\x10\0\0\0", 4)) ==
          scratch / "bad.vdb" + " is damaged: grid 'density': metadata 'file_mem_bytes' has another length than its type");
    CHECK(refusal(size, std::string(4, '\x7f')) == scratch / "bad.vdb" + " is damaged: grid 'density': length: iostream error");
}

TEST_CASE("a grid whose values are said to lie before its tree is refused") {
    const Scratch scratch;
    const auto whole = Scratch::read(std::string(TEST_DATA) + "/vdb/cortex_points.vdb");
    constexpr std::size_t block_position = 0xa4 + sizeof(std::int64_t);
    for (const auto position : {std::numeric_limits<std::int64_t>::min(), std::int64_t{-1}, std::int64_t{0}}) {
        INFO("position " << position);
        auto changed = whole;
        std::memcpy(changed.data() + block_position, &position, sizeof position);
        scratch.write("astray.vdb", changed);
        CHECK(failure_of([&] { read_vdb(scratch / "astray.vdb"); }).starts_with(scratch / "astray.vdb"));
        CHECK_FALSE(VdbFile(scratch / "astray.vdb").memory(0));
    }
}

TEST_CASE("a missing file counts as an input fault, a failed write does not") {
    try {
        read_vdb("/nowhere.vdb");
        FAIL("read");
    } catch (const Failure& failure) {
        CHECK(failure.kind == Failure::Kind::input);
    }
    try {
        write_vdb("/proc/nowhere/out.vdb", {});
        FAIL("written");
    } catch (const Failure& failure) {
        CHECK(failure.kind == Failure::Kind::data);
    }
}

TEST_CASE("a full disk leaves the old file alone and no other behind") {
    const Scratch scratch;
    const auto path = scratch.write("out.vdb", "old");
    const auto volume = read_vdb(std::string(TEST_DATA) + "/vdb/oiio_sphere.vdb");
    // A limit on the size of files stands in for the disk.
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const rlimit tight{50000, before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &tight);
    const auto message = failure_of([&] { write_vdb(path, volume); });
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    CHECK(message == "cannot write " + path + ": the file did not come out whole; is the disk full?");
    CHECK(Scratch::read(path) == "old");
    CHECK(std::distance(std::filesystem::directory_iterator(scratch.path()), {}) == 1);
}

TEST_CASE("what a grid takes is counted from its topology, and refused beyond the memory") {
    const Scratch scratch;
    // Far from each other: each voxel has inner nodes of its own.
    const auto far_voxels = [](const std::string& name, int count) {
        const auto out = FloatGrid::create();
        out->setName(name);
        for (int n = 0; n < count; ++n) out->tree().setValue(openvdb::Coord(4096 * n, 0, 0), 1.0f);
        return out;
    };
    const auto sparse = far_voxels("sparse", 20), large = far_voxels("large", 260);
    const auto tile = FloatGrid::create();
    tile->setName("tile");
    tile->tree().root().addTile(openvdb::Coord(0), 1.0f, true);
    const auto path = scratch / "grids.vdb";
    write_vdb(path, {{sparse, tile, large}, {}, {}});

    VdbFile file(path);
    const auto of_sparse = file.memory(0), of_tile = file.memory(1);
    REQUIRE(of_sparse);
    CHECK(static_cast<double>(of_sparse->tree) == Approx(static_cast<double>(sparse->memUsage())).epsilon(0.1));
    CHECK(of_sparse->dense == 20 * sizeof(float));
    REQUIRE(of_tile);
    CHECK(of_tile->tree < 1000);
    CHECK(of_tile->dense == (std::uint64_t{1} << 36) * sizeof(float));
    CHECK(file.read(0)->activeVoxelCount() == 20);

    CHECK_FALSE(file.memory(2));  // its topology is larger than a survey reads
    CHECK(failure_of([&] { VdbFile(path, 1'000'000).read(2); }).starts_with(path + ": grid 'large' takes 7"));
    CHECK(failure_of([&] { VdbFile(path, 1'000'000).read(); }).ends_with(" MB of memory, but --memory allows 1.00 MB: crop the grid, or raise --memory"));
    CHECK(VdbFile(path, 1'000'000).read(1)->activeVoxelCount() == std::uint64_t{1} << 36);
}
