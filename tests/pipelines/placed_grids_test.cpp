#include "formats/vdb/vdb_file.h"
#include "tests/support/files/vdb_sequences.h"
#include "tests/support/program.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <filesystem>
#include <map>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::FloatGrid;
using openvdb::Mat4d;
using openvdb::Vec3d;

namespace {

/// How a grid is stored: index axis n holds axis `from[n]` of the original, backwards where
/// `sign[n]` is -1, and voxels move by `shift` each frame.
struct Storage {
    std::array<int, 3> from{0, 1, 2};
    std::array<int, 3> sign{1, 1, 1};
    Coord shift{0, 0, 0};
    Mat4d world = Mat4d::identity();  ///< of the copy, behind the original's transform

    Coord voxel(const Coord& at, int frame) const {
        Coord out;
        for (int n = 0; n < 3; ++n)
            out[n] = sign[static_cast<std::size_t>(n)] * at[from[static_cast<std::size_t>(n)]] +
                     (frame - 51) * shift[n];
        return out;
    }
    openvdb::math::Transform::Ptr transform(const openvdb::math::Transform& original,
                                            int frame) const {
        auto back = Mat4d::identity();  // from the copy's voxels to the original's, as rows
        for (int n = 0; n < 3; ++n) {
            const auto row = static_cast<std::size_t>(n);
            for (int axis = 0; axis < 3; ++axis) back(n, axis) = axis == from[row] ? sign[row] : 0;
        }
        for (int axis = 0; axis < 3; ++axis)
            for (int n = 0; n < 3; ++n) back(3, axis) -= (frame - 51) * shift[n] * back(n, axis);
        return openvdb::math::Transform::createLinearTransform(
            back * original.baseMap()->getAffineMap()->getMat4() * world);
    }
};

/// Writes three frames of the plume as `storage` has them, carves them, and returns the carved
/// grids in the original's voxels.
std::map<int, FloatGrid::Ptr> carved_copy(const std::string& folder, const Storage& storage,
                                          const std::string& arguments) {
    std::filesystem::create_directories(folder);
    for (int frame = 51; frame <= 53; ++frame) {
        const auto original = density_in(file_at(SOURCE_ROOT "/tests/data/plume/plume", frame));
        const auto copy = FloatGrid::create();
        REQUIRE(original->tree().activeTileCount() == 0);
        for (auto value = original->cbeginValueOn(); value; ++value)
            copy->tree().setValue(storage.voxel(value.getCoord(), frame), *value);
        copy->setName("density");
        copy->setGridClass(openvdb::GRID_FOG_VOLUME);
        copy->setTransform(storage.transform(original->transform(), frame));
        openvdb::io::File(file_at(folder + "/in", frame)).write({copy});
    }
    const auto ran =
        call_shell(fmt::format("{} carve {}/in.####.vdb {} -o {}/out.####.vdb --progress none",
                               FLUIDCARVE_PROGRAM, folder, arguments, folder));
    INFO(ran.err);
    REQUIRE(ran.code == 0);
    CHECK(ran.err.find("warning") == std::string::npos);
    std::map<int, FloatGrid::Ptr> out;
    for (int frame = 51; frame <= 53; ++frame) {
        const auto result = density_in(file_at(folder + "/out", frame));
        CHECK(result->transform() == density_in(file_at(folder + "/in", frame))->transform());
        auto& back = out[frame] = FloatGrid::create();
        for (auto value = result->cbeginValueOn(); value; ++value) {
            const auto at = value.getCoord() - Coord((frame - 51) * storage.shift[0],
                                                     (frame - 51) * storage.shift[1],
                                                     (frame - 51) * storage.shift[2]);
            Coord original;
            for (int n = 0; n < 3; ++n)
                original[storage.from[static_cast<std::size_t>(n)]] =
                    storage.sign[static_cast<std::size_t>(n)] * at[n];
            back->tree().setValue(original, *value);
        }
    }
    return out;
}

double difference(const FloatGrid& a, const FloatGrid& b) {
    double out = 0;
    for (auto value = a.cbeginValueOn(); value; ++value)
        out = std::max<double>(out, std::abs(*value - b.tree().getValue(value.getCoord())));
    for (auto value = b.cbeginValueOn(); value; ++value)
        out = std::max<double>(out, std::abs(*value - a.tree().getValue(value.getCoord())));
    return out;
}

Mat4d scaled(double by) {
    auto out = Mat4d::identity();
    out.setToScale(Vec3d(by));
    return out;
}

Mat4d moved(const Vec3d& by) {
    auto out = Mat4d::identity();
    out.setToTranslation(by);
    return out;
}

Mat4d turned(double degrees) {
    auto out = Mat4d::identity();
    out.setToRotation(openvdb::math::Z_AXIS, degrees * M_PI / 180);
    return out;
}

}  // namespace

TEST_CASE(
    "a carve does not depend on how voxels are stored, nor on where, how large and how turned the "
    "world has them",
    "[nightly][long]") {
    const double voxel =
        density_in(SOURCE_ROOT "/tests/data/plume/plume.0051.vdb")->voxelSize().x();
    const std::map<std::string, Storage> copies{
        {"mirrored", {{0, 1, 2}, {-1, 1, 1}}},
        {"mirrored in three axes", {{0, 1, 2}, {-1, -1, -1}}},
        {"turned by 90 degrees in store", {{1, 0, 2}, {1, -1, 1}}},
        {"axes permuted", {{2, 0, 1}, {1, 1, 1}}},
        {"turned by 30 degrees in the world", {{0, 1, 2}, {1, 1, 1}, {0, 0, 0}, turned(30)}},
        {"in a container that moves", {{0, 1, 2}, {1, 1, 1}, {5, -3, 7}}},
        {"far away", {{0, 1, 2}, {1, 1, 1}, {0, 0, 0}, moved(Vec3d(1e6, -1e6, 1e6) * voxel)}},
        {"small", {{0, 1, 2}, {1, 1, 1}, {0, 0, 0}, scaled(1e-3)}},
        {"large", {{0, 1, 2}, {1, 1, 1}, {0, 0, 0}, scaled(1e3)}},
    };
    const Scratch scratch;
    for (const std::string arguments : {"-12", "8 --solver warp --conserve mass"}) {
        const auto expected = carved_copy(scratch / "original", {}, arguments);
        for (const auto& [name, storage] : copies) {
            INFO(name << ", " << arguments);
            const auto result = carved_copy(scratch / "copy", storage, arguments);
            for (const auto& [frame, grid] : result)
                CHECK(difference(*grid, *expected.at(frame)) < 2e-5);
        }
    }
}

TEST_CASE("sheared voxels, and voxels that are no cubes, are carved in their own index space") {
    auto sheared = Mat4d::identity(), longer = Mat4d::identity();
    sheared(1, 0) = 0.3;
    longer(0, 0) = 1.01;
    const Scratch scratch;
    const auto wide = [](const FloatGrid& grid) {
        return grid.evalActiveVoxelBoundingBox().dim().x();
    };
    for (const auto& world : {sheared, longer})
        for (const auto& [frame, grid] :
             carved_copy(scratch / "copy", {{0, 1, 2}, {1, 1, 1}, {0, 0, 0}, world}, "-12")) {
            const auto before =
                wide(*density_in(file_at(SOURCE_ROOT "/tests/data/plume/plume", frame)));
            CHECK(wide(*grid) <= before - 10);
            CHECK(wide(*grid) >= before - 12);
        }
}
