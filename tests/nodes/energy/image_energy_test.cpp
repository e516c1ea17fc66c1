#include "carve/lattice/lattice.h"
#include "carve/remap/grid.h"
#include "carve/solver/costs/sample.h"
#include "carve/solver/dynamic.h"
#include "formats/file/module.h"
#include "formats/image/image_volume.h"
#include "nodes/energy_image.h"
#include "tests/support/brute_force.h"
#include "tests/support/node_bench.h"
#include "tests/support/seams_through.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;

namespace {

Image random_image(int width, int height, const std::vector<std::string>& names,
                   unsigned seed = 1) {
    Image out;
    out.format = "png";
    out.data = out.display = {0, 0, width, height};
    std::mt19937 random(seed);
    for (const auto& name : names) out.channels.push_back({name, "uint8"});
    for (std::size_t n = 0; n < static_cast<std::size_t>(width * height) * names.size(); ++n)
        out.pixels.push_back(static_cast<float>(random() % 256) / 255);
    return out;
}

float at(const FloatGrid& grid, int x, int y) { return grid.tree().getValue({x, y, 0}); }

/// The part of a photograph that begins at a pixel.
Image part_of(const std::string& path, int x, int y, int width, int height) {
    const auto photo = load_module<ImageModule>("images").read(path, format_of_file(path).name);
    auto out = photo;
    out.data = out.display = {0, 0, width, height};
    out.pixels.clear();
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i)
            for (std::size_t c = 0; c < photo.channels.size(); ++c)
                out.pixels.push_back(
                    photo.pixels[static_cast<std::size_t>((y + j) * photo.data.width + x + i) *
                                     photo.channels.size() +
                                 c]);
    return out;
}

EnergyVolume energies_of(const FloatGrid& energy, int width, int height) {
    EnergyVolume out({{width, height, 1}, Axis::u, 1});
    sample_energy(energy, make_box(openvdb::Vec3d(0), {width, height, 1}, 1, {0, 1, 2}), Axis::u,
                  out.codes(0));
    return out;
}

/// The least energy of a seam through rows of energies, by the recurrence of Avidan and Shamir as
/// it stands in their paper.
double least_energy(const EnergyVolume& energy) {
    std::vector<double> ways(static_cast<std::size_t>(energy.width()), 0.0);
    for (int row = 0; row < energy.laterals(); ++row) {
        const auto before = ways;
        for (int i = 0; i < energy.width(); ++i) {
            auto least = before[static_cast<std::size_t>(i)];
            if (i > 0) least = std::min(least, before[static_cast<std::size_t>(i - 1)]);
            if (i + 1 < energy.width())
                least = std::min(least, before[static_cast<std::size_t>(i + 1)]);
            ways[static_cast<std::size_t>(i)] =
                least + static_cast<double>(decode_energy(
                            energy.codes(0)[static_cast<std::size_t>(row) * energy.stride() +
                                            static_cast<std::size_t>(i)]));
        }
    }
    return *std::ranges::min_element(ways);
}

const Tick nobody = [](double) {};

}  // namespace

TEST_CASE(
    "the energy of an image is the sum of its intensity's absolute derivatives: central ones, "
    "one-sided at the rims",
    "[images]") {
    const int width = 11, height = 9;
    const auto image = random_image(width, height, {"R", "G", "B", "A"});
    const auto energy = image_energy(volume_of(image));
    CHECK(energy->activeVoxelCount() == width * height);
    const auto value = [&](int x, int y) {
        const auto* const pixel =
            image.pixels.data() + static_cast<std::size_t>((height - 1 - y) * width + x) * 4;
        return 0.2126 * static_cast<double>(pixel[0]) + 0.7152 * static_cast<double>(pixel[1]) +
               0.0722 * static_cast<double>(pixel[2]);
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const int left = std::max(x - 1, 0), right = std::min(x + 1, width - 1),
                      low = std::max(y - 1, 0), high = std::min(y + 1, height - 1);
            const double want = std::abs(value(right, y) - value(left, y)) / (right - left) +
                                std::abs(value(x, high) - value(x, low)) / (high - low);
            REQUIRE(static_cast<double>(at(*energy, x, y)) == Approx(want).margin(1e-6));
        }
}

TEST_CASE("an image one pixel wide has no derivative across, and one pixel alone none",
          "[images]") {
    CHECK(at(*image_energy(volume_of(random_image(1, 1, {"Y"}))), 0, 0) == 0);
    const auto line = random_image(1, 3, {"Y"});
    CHECK(at(*image_energy(volume_of(line)), 0, 0) ==
          Approx(std::abs(line.pixels[1] - line.pixels[2])));
}

TEST_CASE("intensity without R, G and B is the mean of all channels but opacity, or of those named",
          "[images]") {
    const auto image = random_image(5, 4, {"Y", "U", "A", "matte.A"});
    const auto volume = volume_of(image);
    CHECK(at(*intensity(volume), 2, 3) ==
          Approx(0.5 * static_cast<double>(image.pixels[8] + image.pixels[9])));
    CHECK(at(*intensity(volume, std::vector<std::string>{"A"}), 2, 3) == image.pixels[10]);
    CHECK(intensity(volume)->getName() == "intensity of Y, U");
    CHECK(failure_of([&] { intensity(volume, std::vector<std::string>{"Q"}); }) ==
          "there is no channel 'Q'; there are Y, U, A, matte.A");
    CHECK(failure_of([&] { intensity(volume_of(random_image(2, 2, {"A"}))); }) ==
          "there is no channel to compute the energy from; there are A: name some in `channels`");
    Volume vectors;
    vectors.grids = {VectorGrid::create()};
    CHECK_THAT(
        failure_of([&] { intensity(vectors); }),
        Catch::Contains("a channel of an image is a float grid; name the `channels` to take"));
}

TEST_CASE("beside what is not active the derivative is one-sided", "[images]") {
    auto volume = volume_of(random_image(6, 1, {"Y"}));
    const auto grid = openvdb::gridConstPtrCast<FloatGrid>(volume.grids[0])->deepCopy();
    grid->tree().setValueOff({3, 0, 0}, 100);
    volume.grids[0] = grid;
    const auto energy = image_energy(volume);
    CHECK(at(*energy, 2, 0) == Approx(std::abs(at(*grid, 2, 0) - at(*grid, 1, 0))));
    CHECK(at(*energy, 4, 0) == Approx(std::abs(at(*grid, 5, 0) - at(*grid, 4, 0))));
    CHECK_FALSE(energy->tree().isValueOn({3, 0, 0}));
}

TEST_CASE(
    "the energy of a volume is that of its planes, whatever is active in which channel, tiles too",
    "[images]") {
    std::mt19937 random(8);
    Volume volume;
    for (const auto* const name : {"R", "G", "B"}) {
        const auto grid = FloatGrid::create(static_cast<float>(random() % 8));
        grid->setName(name);
        for (int n = 0; n < 3000; ++n)
            grid->tree().setValue(
                {static_cast<int>(random() % 24) - 9, static_cast<int>(random() % 20) - 4,
                 static_cast<int>(random() % 12) - 2},
                static_cast<float>(random() % 256) / 16);
        if (grid->getName() != "R")
            grid->tree().addTile(1, {8, 0, 0}, static_cast<float>(random() % 256) / 16, true);
        volume.grids.push_back(grid);
    }
    const auto energy = image_energy(volume), plane = intensity(volume);
    CHECK(energy->activeVoxelCount() == plane->activeVoxelCount());
    const auto values = plane->getConstAccessor();
    const auto slope = [&](const openvdb::Coord& at, const openvdb::Coord& step) {
        const bool low = values.isValueOn(at - step), high = values.isValueOn(at + step);
        return std::abs(values.getValue(high ? at + step : at) -
                        values.getValue(low ? at - step : at)) *
               (low && high ? 0.5f : 1.0f);
    };
    for (auto voxel = energy->cbeginValueOn(); voxel; ++voxel) {
        const auto at = voxel.getCoord();
        REQUIRE(values.isValueOn(at));
        REQUIRE(*voxel == slope(at, {1, 0, 0}) + slope(at, {0, 1, 0}));
    }
}

TEST_CASE("a channel that is not finite is refused with the lowest voxel", "[images]") {
    auto volume = volume_of(random_image(30, 20, {"Y"}));
    const auto grid = openvdb::gridConstPtrCast<FloatGrid>(volume.grids[0])->deepCopy();
    grid->tree().setValue({25, 3, 0}, NAN);
    grid->tree().setValue({11, 7, 0}, INFINITY);
    volume.grids[0] = grid;
    CHECK_THAT(failure_of([&] { image_energy(volume); }),
               Catch::Contains("'intensity of Y'") && Catch::Contains("[11, 7, 0]"));
}

TEST_CASE(
    "seam.dynamic takes a seam of least energy out of small pictures, as trying all of them shows",
    "[images]") {
    for (unsigned seed = 0; seed < 40; ++seed) {
        const int width = 2 + static_cast<int>(seed % 6), height = 1 + static_cast<int>(seed % 8);
        const auto energy = energies_of(
            *image_energy(volume_of(random_image(width, height, {"Y"}, seed))), width, height);
        const ColumnGraph graph({height, 1, 1});
        const auto band = Band::whole(static_cast<std::size_t>(height), {0, width - 1});
        const auto seam = DynamicSeams()(energy, {0, width - 1}, static_cast<int>(seed), nobody);
        REQUIRE(is_seam(graph, band, seam.at));
        REQUIRE(seam.energy ==
                Approx(brute_force(graph, band, energies_of(energy)).cost).epsilon(1e-12));
        REQUIRE(sum_along(seam.at, energies_of(energy)) == Approx(seam.energy).epsilon(1e-12));
    }
}

TEST_CASE(
    "seam after seam, seam.dynamic has the least energy that is left in a photograph, and the "
    "picture is what they leave",
    "[images]") {
    const int width = 200, height = 150, count = 40;
    const auto image = part_of(TEST_DATA "/images/chelsea.png", 100, 60, width, height);
    const auto volume = volume_of(image);
    const auto field = image_energy(volume);
    auto energy = energies_of(*field, width, height);
    const ColumnGraph graph({height, 1, 1});
    auto left = image;
    const auto lattice = make_box(openvdb::Vec3d(0), {width, height, 1}, 1, {0, 1, 2});
    auto seams = std::make_shared<Seams>(no_seams(lattice));
    for (int n = 0; n < count; ++n) {
        auto seam = DynamicSeams()(energy, {0, energy.width() - 1}, n, nobody);
        REQUIRE(is_seam(graph,
                        Band::whole(static_cast<std::size_t>(height), {0, energy.width() - 1}),
                        seam.at));
        REQUIRE(seam.energy == least_energy(energy));
        REQUIRE(sum_along(seam.at, energies_of(energy)) == Approx(seam.energy).epsilon(1e-12));
        energy.remove(seam.at);
        std::vector<float> pixels;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width - n; ++x)
                if (x != seam.at[static_cast<std::size_t>(height - 1 - y)])
                    for (std::size_t c = 0; c < 3; ++c)
                        pixels.push_back(
                            left.pixels[static_cast<std::size_t>(y * (width - n) + x) * 3 + c]);
        left.pixels = std::move(pixels);
        seams->seams.push_back(std::move(seam));
    }
    const auto carved = carve_volume(volume, lattice, CarveMap(lattice, {seams}, 1, std::nullopt),
                                     Interpolation::linear);
    const auto out = image_of(carved, {format_of_name("a.png"), {}, {}},
                              [](const std::string& warning) { FAIL(warning); });
    CHECK(out.data == Image::Window{0, 0, width - count, height});
    CHECK(out.display == out.data);
    CHECK(out.pixels == left.pixels);
}
