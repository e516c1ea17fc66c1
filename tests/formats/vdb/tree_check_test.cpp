#include "carve/stream/tree_check.h"

#include "carve/stream/raw_grid.h"
#include "formats/vdb/vdb_file.h"
#include "tests/support/scratch.h"

#include <openvdb/io/File.h>
#include <openvdb/points/PointConversion.h>
#include <catch2/catch.hpp>

#include <cstring>
#include <random>

using namespace fluidcarve;
using openvdb::Coord;

namespace {

/// Grids of all kinds of trees: values, bools, masks, points; and point indices, which OpenVDB
/// cannot read.
openvdb::GridCPtrVec all_kinds() {
    openvdb::initialize();
    const auto filled = [](auto grid, const std::string& name, const auto& value) {
        for (int n = 0; n < 300; ++n)
            grid->tree().setValue(Coord(7 * n - 900, 3 * n, -n), value(n));
        grid->tree().addTile(1, Coord(64, -512, 8), value(3), true);
        grid->tree().addTile(2, Coord(0, 5000, 0), value(4), true);
        grid->tree().root().addTile(Coord(8192, 0, 0), value(5), false);
        grid->setName(name);
        return openvdb::GridBase::ConstPtr(grid);
    };
    const auto number = [](int n) { return 0.1f * static_cast<float>(n % 17); };
    std::vector<openvdb::Vec3R> places;
    for (int n = 0; n < 500; ++n) places.emplace_back(0.37 * n, 0.11 * n, -0.21 * n);
    const auto transform = openvdb::math::Transform::createLinearTransform(2.0);
    const auto points =
        openvdb::points::createPointDataGrid<openvdb::points::NullCodec,
                                             openvdb::points::PointDataGrid>(places, *transform);
    points->setName("points");
    const auto indices = openvdb::tools::createPointIndexGrid<openvdb::tools::PointIndexGrid>(
        openvdb::points::PointAttributeVector<openvdb::Vec3R>(places), *transform);
    indices->setName("indices");
    auto half = filled(openvdb::FloatGrid::create(), "half", number);
    std::const_pointer_cast<openvdb::GridBase>(half)->setSaveFloatAsHalf(true);
    return {filled(openvdb::FloatGrid::create(), "float", number),
            half,
            filled(openvdb::DoubleGrid::create(2), "double", [](int n) { return 1.0 / (n + 1); }),
            filled(openvdb::Int64Grid::create(), "int64", [](int n) { return std::int64_t{n}; }),
            filled(openvdb::Vec3SGrid::create(), "vec3s",
                   [](int n) { return openvdb::Vec3s(static_cast<float>(n)); }),
            filled(openvdb::Vec3DGrid::create(), "vec3d", [](int n) { return openvdb::Vec3d(n); }),
            filled(openvdb::BoolGrid::create(), "bool", [](int n) { return n % 3 == 0; }),
            filled(openvdb::MaskGrid::create(), "mask", [](int) { return true; }),
            points,
            indices};
}

std::string file_of(const Scratch& scratch, const openvdb::GridCPtrVec& grids,
                    std::uint32_t compression) {
    openvdb::io::File file(scratch / "grids.vdb");
    file.setCompression(compression);
    file.write(grids);
    file.close();
    return Scratch::read(scratch / "grids.vdb");
}

/// What reading the file ends with: nothing, or a message.
std::string fault_of_file(const Scratch& scratch, const std::string& bytes) {
    const auto path = scratch.write("mutant.vdb", bytes);
    try {
        read_vdb(path);
    } catch (const Failure& failure) {
        return failure.what();
    }
    return {};
}

}  // namespace

TEST_CASE("trees of all kinds and codecs pass the check and are read as they are") {
    using namespace openvdb::io;
    const Scratch scratch;
    const auto grids = all_kinds();
    for (const std::uint32_t compression :
         {COMPRESS_NONE + 0, COMPRESS_ACTIVE_MASK + 0, COMPRESS_ZIP | COMPRESS_ACTIVE_MASK,
          COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK}) {
        CHECK(fault_of_file(scratch, file_of(scratch, grids, compression)) == "");
        const auto volume = read_vdb(scratch / "grids.vdb");
        REQUIRE(volume.grids.size() == grids.size());
        for (const auto& grid : volume.grids) {
            if (RawGrid::of(grid.header())) continue;
            const auto same = [&](const auto& each) { return each->getName() == grid->getName(); };
            CHECK(grid->activeVoxelCount() ==
                  (*std::ranges::find_if(grids, same))->activeVoxelCount());
        }
    }
}

TEST_CASE("a wrong length of any chunk of values is found before it is read") {
    const Scratch scratch;
    auto grids = all_kinds();
    grids.pop_back();  // point indices are kept as bytes
    const auto whole =
        file_of(scratch, grids, openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
    std::size_t chunks = 0;
    for (std::size_t at = 0; at + 24 < whole.size(); ++at) {
        // The length of a chunk, and behind it blosc's header, which repeats it.
        std::int64_t length = 0;
        std::uint32_t stated = 0;
        std::memcpy(&length, whole.data() + at, sizeof length);
        std::memcpy(&stated, whole.data() + at + 20, sizeof stated);
        if (length < 16 || length != stated || whole[at + 8] != 2) continue;
        if (++chunks % 29 != 1) continue;
        for (const std::int64_t wrong :
             {-length, std::int64_t{-1000000}, length + 1, std::int64_t{1} << 60,
              std::numeric_limits<std::int64_t>::min()}) {
            auto mutant = whole;
            std::memcpy(mutant.data() + at, &wrong, sizeof wrong);
            CHECK(fault_of_file(scratch, mutant).find("cannot read grid") != std::string::npos);
        }
        auto mutant = whole;
        const std::uint32_t larger = 1U << 30;
        std::memcpy(mutant.data() + at + 12, &larger, sizeof larger);
        CHECK(fault_of_file(scratch, mutant).find("compressed values have a wrong length") !=
              std::string::npos);
    }
    CHECK(chunks > 20);
}

TEST_CASE("points outside of a tree's leaves are refused") {
    const Scratch scratch;
    openvdb::initialize();
    using Tree = openvdb::points::PointDataTree;
    const auto refusal = [&](const std::string& name, const auto& spoil) {
        const auto grid = openvdb::points::PointDataGrid::create();
        grid->setName(name);
        spoil(grid->tree().root());
        return fault_of_file(scratch, file_of(scratch, {grid}, openvdb::io::COMPRESS_NONE));
    };
    CHECK(refusal("none", [](auto&) {}) == "");
    CHECK(refusal("background", [](auto& root) {
              root.setBackground(Tree::ValueType(1), false);
          }).find("it has points outside of its leaves") != std::string::npos);
    CHECK(refusal("tile", [](auto& root) {
              root.addTile(Coord(4096, 0, 0), Tree::ValueType(256), true);
          }).find("it has points outside of its leaves") != std::string::npos);
}

TEST_CASE("files with random faults are read or refused") {
    const Scratch scratch;
    const auto grids = all_kinds();
    std::mt19937 random(7);
    for (const std::uint32_t compression :
         {openvdb::io::COMPRESS_NONE + 0,
          openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK}) {
        // One kind after another: a fault in the first grid hides the others.
        for (const auto& grid : grids) {
            const auto whole = file_of(scratch, {grid}, compression);
            for (int n = 0; n < 25; ++n) {
                auto mutant = whole;
                for (int faults = 0; faults < 3; ++faults) {
                    const auto at = random() % (mutant.size() - 8);
                    const std::uint64_t number =
                        random() % 2 ? random() : ~std::uint64_t{0} << (random() % 64);
                    std::memcpy(mutant.data() + at, &number, 1 + random() % 8);
                }
                fault_of_file(scratch, mutant);
            }
        }
    }
}

TEST_CASE("active voxels are counted with those of tiles") {
    const auto grid = openvdb::FloatGrid::create();
    grid->tree().root().addTile(Coord(0), 1.0f, true);
    grid->tree().addTile(2, Coord(4096, 0, 0), 1.0f, true);
    grid->tree().addTile(1, Coord(8192, 0, 0), 1.0f, true);
    grid->tree().setValue(Coord(8200, 0, 0), 1.0f);
    std::ostringstream out(std::ios_base::binary);
    openvdb::io::setDataCompression(out, openvdb::io::COMPRESS_NONE);
    grid->tree().writeTopology(out);
    const auto bytes = out.str();
    const auto size =
        size_of_tree(tree_format("Tree_float_5_4_3", false, openvdb::OPENVDB_FILE_VERSION,
                                 openvdb::io::COMPRESS_NONE),
                     bytes);
    CHECK(size.active_voxels == grid->activeVoxelCount());
    CHECK(static_cast<double>(size.bytes) ==
          Approx(static_cast<double>(grid->memUsage())).epsilon(0.2));
}
