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
#include <cstring>
#include <random>

using namespace fluidcarve;
using test::difference;
using test::failure_of;

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
            path +
            (size < header
                 ? fmt::format(
                       " is cut off: it ends within its header, at byte {}; copy or write it again",
                       size)
                 : fmt::format(" is cut off: grid 'points' ends at byte {}, the file at {}; copy "
                               "or write it again",
                               whole.size(), size));
        const std::function<void()> readers[] = {[&] { read_vdb_header(path); },
                                                 [&] { read_vdb(path); },
                                                 [&] { read_vdb_grid(path, "points"); }};
        for (const auto& read : readers) {
            std::string told;
            try {
                read();
            } catch (const Failure& failure) {
                told =
                    failure.kind == Failure::Kind::input ? failure.what() : "not the input's fault";
            }
            CHECK(told == wanted);
        }
    }
}

TEST_CASE("what is wrong with a file is said in words") {
    const Scratch scratch;
    const auto whole = Scratch::read(std::string(TEST_DATA) + "/vdb/cortex_points.vdb");
    const auto refusal = [&](const std::string& name) {
        return failure_of([&] { read_vdb(scratch / name); });
    };
    const auto is = [&](const std::string& name, const std::string& message) {
        CHECK(refusal(name) == scratch / name + message);
    };

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
    is("cut.vdb",
       " is cut off: grid 'points' ends at byte 38933, the file at 30000; copy or write it again");

    auto changed = whole;
    const std::size_t positions = 0xa4;
    REQUIRE(whole.substr(positions, 8) == std::string("\xbc\0\0\0\0\0\0\0", 8));
    changed.replace(positions, 24, 24, '\0');
    scratch.write("unfinished.vdb", changed);
    is("unfinished.vdb",
       " is unfinished or damaged: it does not say where grid 'points' ends; wait for its writer, "
       "or write it again");
    changed = Scratch::read(std::string(TEST_DATA) + "/vdb/cortex_sphere.vdb");
    changed[changed.find("Tree_float")] = 'X';
    scratch.write("strange.vdb", changed);
    is("strange.vdb",
       fmt::format(": grid 'ls_sphere' is of type Xree_float_5_4_3, which OpenVDB {} does not "
                   "know; it can be copied unchanged only from a file of version {}, but this one "
                   "has 222: write the file without this grid",
                   openvdb::getLibraryVersionString(),
                   static_cast<unsigned>(openvdb::OPENVDB_FILE_VERSION)));
    changed = whole;
    changed[8] = '\xff';
    scratch.write("newer.vdb", changed);
    is("newer.vdb",
       " has file version 255, and 225 is the newest that can be read: write it with an older "
       "OpenVDB");
    // What OpenVDB 13 writes.
    changed = Scratch::read(TEST_DATA "/plume/plume.0051.vdb");
    REQUIRE(changed[8] == '\xe0');
    changed[8] = '\xe1';
    scratch.write("of13.vdb", changed);
    CHECK(read_vdb_header(scratch / "of13.vdb").version == 225);
    CHECK(read_vdb(scratch / "of13.vdb").grids.size() ==
          read_vdb(TEST_DATA "/plume/plume.0051.vdb").grids.size());

    const auto odd = FloatGrid::create();
    odd->setName("odd");
    odd->insertMeta("class", openvdb::Int32Metadata(3));
    openvdb::io::File(scratch / "class.vdb").write(openvdb::GridCPtrVec{odd});
    is("class.vdb",
       ": cannot read grid 'odd': its metadata 'class' has the type int32, but must have the type "
       "string; write or copy the file again");

    const auto path = std::string(TEST_DATA) + "/plume/plume.0051.vdb";
    CHECK(failure_of([&] { read_vdb_grid(path, "densty"); }) ==
          path +
              " has no grid 'densty'; it has velocity, density, shadow, temperature, flame; did "
              "you mean 'density'?");
    write_vdb(scratch / "bare.vdb", Volume{});
    CHECK(failure_of([&] { read_vdb_grid(scratch / "bare.vdb", "density"); }) ==
          scratch / "bare.vdb" + " has no grid 'density'; it has none");
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
    CHECK(refusal(map + 24, std::string(8, '\xff')) ==
          scratch / "bad.vdb" + " is damaged: the transform of grid 'density' is not finite");
    // The map's name is followed by a translation, three scales, the voxel's edges and the inverses
    // of the scales.
    for (const auto& [nth, number] :
         {std::pair{3, 0.0}, {3, 5.0}, {7, 1e-3}, {8, -0.2}, {11, 1e9}}) {
        INFO("number " << nth << " is " << number);
        CHECK(refusal(map + 24 + 8 * static_cast<std::size_t>(nth),
                      std::string(reinterpret_cast<const char*>(&number), sizeof number)) ==
              scratch / "bad.vdb" +
                  " is damaged: the numbers of the transform of grid 'density' contradict each "
                  "other; write or copy the file again");
    }
    // The entry's type, int64, follows its name; then comes its size, 8.
    const auto size = whole.find("int64", statistic) + 5;
    CHECK(refusal(size, std::string("\x10\0\0\0", 4)) ==
          scratch / "bad.vdb" +
              " is damaged: grid 'density': metadata 'file_mem_bytes' has another length than its "
              "type");
    CHECK(refusal(size, std::string(4, '\x7f')) ==
          scratch / "bad.vdb" + " is damaged: grid 'density': length: iostream error");
}

TEST_CASE("a grid whose values are said to lie before its tree is refused") {
    const Scratch scratch;
    const auto whole = Scratch::read(std::string(TEST_DATA) + "/vdb/cortex_points.vdb");
    constexpr std::size_t block_position = 0xa4 + sizeof(std::int64_t);
    for (const auto position :
         {std::numeric_limits<std::int64_t>::min(), std::int64_t{-1}, std::int64_t{0}}) {
        INFO("position " << position);
        auto changed = whole;
        std::memcpy(changed.data() + block_position, &position, sizeof position);
        scratch.write("astray.vdb", changed);
        CHECK(failure_of([&] {
                  read_vdb(scratch / "astray.vdb");
              }).starts_with(scratch / "astray.vdb"));
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
    CHECK(message ==
          "cannot write " + path + ": the file did not come out whole; is the disk full?");
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
    CHECK(static_cast<double>(of_sparse->tree) ==
          Approx(static_cast<double>(sparse->memUsage())).epsilon(0.1));
    CHECK(of_sparse->dense == 20 * sizeof(float));
    REQUIRE(of_tile);
    CHECK(of_tile->tree < 1000);
    CHECK(of_tile->dense == (std::uint64_t{1} << 36) * sizeof(float));
    CHECK(file.read(0)->activeVoxelCount() == 20);

    CHECK_FALSE(file.memory(2));  // its topology is larger than a survey reads
    CHECK(failure_of([&] {
              VdbFile(path, 1'000'000).read(2);
          }).starts_with(path + ": grid 'large' takes 7"));
    CHECK(failure_of([&] { VdbFile(path, 1'000'000).read(); })
              .ends_with(
                  " MB of memory, but --memory allows 1.00 MB: crop the grid, or raise --memory"));
    CHECK(VdbFile(path, 1'000'000).read(1)->activeVoxelCount() == std::uint64_t{1} << 36);
}
