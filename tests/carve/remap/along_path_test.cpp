#include "carve/remap/geometry/mesh.h"
#include "carve/remap/geometry/points.h"
#include "carve/remap/grid.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/reference_carve.h"
#include "tests/support/sampled.h"
#include "tests/support/wavy_seams.h"

#include <catch2/catch.hpp>

#include <tuple>

// `axis: w`: planes of the rig leave, or are doubled, and what lies behind them moves along the
// path.

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

namespace {

using Kind = Seams::Kind;

constexpr double path_spacing = 0.5;
constexpr int path_planes = 60;
const Lattice helix_path = helix({13, 11, path_planes}, path_spacing, 12, 3);

/// A density that changes along the path, and across it near its rim.
float path_waves(const Vec3d& at) {
    return static_cast<float>(2 + std::sin(0.9 * at.z()) + 0.3 * std::cos(0.4 * (at.x() + at.y())));
}

FloatGrid::Ptr path_content(float (*value)(const Vec3d&)) {
    const auto box =
        Mapping(helix_path).world_box(openvdb::BBoxd(Vec3d(0), Vec3d(12, 10, path_planes - 1)));
    auto out = FloatGrid::create();
    out->setTransform(openvdb::math::Transform::createLinearTransform(path_spacing));
    const Mapping mapping(helix_path);
    for (auto at = CoordBBox(Coord::floor(box.min() / path_spacing),
                             Coord::ceil(box.max() / path_spacing))
                       .begin();
         at; ++at) {
        const auto world = out->indexToWorld(*at);
        if (mapping.locate(world)) out->tree().setValueOn(*at, value(world));
    }
    return out;
}

CarveMap path_map(const Seams& seams, const Softness& softness = {}) {
    return {helix_path, {std::make_shared<Seams>(seams)}, 1, {}, std::vector{softness}};
}

Seams anchored_path(Seams seams, Anchor anchor) {
    seams.anchor = anchor;
    seams.find_shifts();
    return seams;
}

}  // namespace

TEST_CASE(
    "along a bent path, what lies behind a seam moves on along the path, and what lies before it "
    "stays bit for bit") {
    const auto kind = GENERATE(Kind::remove, Kind::insert);
    const auto anchor = GENERATE(Anchor{}, Anchor{Anchor::At::high, 0});
    const double soft = GENERATE(0.0, 2.0);
    const int count = 6, by = kind == Kind::remove ? count : -count;
    const auto entries =
        kind == Kind::remove ? std::vector<int>(count, 20) : std::vector{20, 21, 22, 23, 24, 25};
    const auto map = path_map(
        anchored_path(straight_seams(helix_path, Axis::w, kind, entries), anchor), {soft, 0});
    const FloatGrid::ConstPtr grid = path_content(path_waves);
    const auto got = carved<FloatGrid>(grid, helix_path, map);
    // Planes of the carved space, counted as in the lattice: those before the seams come from
    // `head` further, those behind from `tail`.
    const int head = anchor.at == Anchor::At::low ? 0 : -by, tail = head + by;
    const Mapping mapping(map.extended(helix_path), map.reach());
    const int below = map.below()[2], reach = static_cast<int>(3 * soft);
    int stayed = 0, moved = 0, freed = 0;
    for (auto voxel = grid->cbeginValueOn(); voxel; ++voxel) {
        const auto at = voxel.getCoord();
        const auto place = mapping.locate(grid->indexToWorld(at));
        if (!place) continue;
        const double w = place->z() - below, begin = 20 - head,
                     end = kind == Kind::remove ? begin : begin + count + 6;
        // Near the rims, where a source may lie outside of the content.
        if (place->x() < 2 || place->x() > 10 || place->y() < 2 || place->y() > 8) continue;
        const bool before = w<begin - 2 - reach, behind = w> end + 2 + reach;
        if (!before && !behind) continue;
        const int shift = before ? head : tail;
        const double from = w + shift;
        if (shift == 0) {
            ++stayed;
            REQUIRE(got->tree().getValue(at) == *voxel);
        } else if (from < -1 || from > path_planes) {
            ++freed;
            REQUIRE(got->tree().getValue(at) == 0);
            REQUIRE(!got->tree().isValueOn(at));
        } else if (from > 2 && from < path_planes - 3) {
            ++moved;
            auto source = *place;
            source.z() += shift;
            REQUIRE(got->tree().getValue(at) ==
                    Approx(path_waves(mapping.position(source))).margin(0.04));
        }
    }
    CHECK(stayed > 250);
    CHECK(moved > 250);
    CHECK((freed > 100 || kind == Kind::insert));
}

TEST_CASE("an insertion lengthens the path straight on beyond its ends") {
    const auto anchor =
        GENERATE(Anchor{}, Anchor{Anchor::At::middle, 0}, Anchor{Anchor::At::high, 0});
    const auto map = path_map(
        anchored_path(straight_seams(helix_path, Axis::w, Kind::insert, {20, 22, 24, 26}), anchor));
    const auto longer = map.extended(helix_path);
    const int below = anchor.at == Anchor::At::low ? 0 : anchor.at == Anchor::At::high ? 4 : 2;
    REQUIRE(map.below() == std::array{0, 0, below});
    REQUIRE(longer.shape == std::array{13, 11, path_planes + 4});
    REQUIRE(longer.planes.size() == path_planes + 4);
    const auto near = [](const Vec3d& a, const Vec3d& b) { return (a - b).length() < 1e-9; };
    for (int k = 0; k < path_planes; ++k)
        CHECK(near(longer.position(Vec3d(3, 4, k + below)), helix_path.position(Vec3d(3, 4, k))));
    for (int n = 1; n <= below; ++n)
        CHECK(near(
            longer.position(Vec3d(3, 4, below - n)),
            helix_path.position(Vec3d(3, 4, 0)) - n * path_spacing * helix_path.planes.front().w));
    for (int n = 1; n <= 4 - below; ++n)
        CHECK(near(longer.position(Vec3d(3, 4, path_planes - 1 + below + n)),
                   helix_path.position(Vec3d(3, 4, path_planes - 1)) +
                       n * path_spacing * helix_path.planes.back().w));
}

TEST_CASE("points and meshes go along the path as the grids do") {
    const auto kind = GENERATE(Kind::remove, Kind::insert);
    const int by = kind == Kind::remove ? -6 : 6;
    const auto entries =
        kind == Kind::remove ? std::vector<int>(6, 20) : std::vector{20, 21, 22, 23, 24, 25};
    const auto map = path_map(straight_seams(helix_path, Axis::w, kind, entries));
    const Mapping longer(map.extended(helix_path), map.reach());
    std::vector<Vec3d> positions;
    std::vector<std::uint64_t> identities;
    for (int n = 0; n < 40; ++n) {
        positions.push_back(helix_path.position(Vec3d(3.3 + 0.1 * (n % 7), 4.7, n + 0.4)));
        identities.push_back(static_cast<std::uint64_t>(n));
    }
    const auto points = carve_points(positions, identities, helix_path, map, 0);
    Mesh mesh;
    mesh.points = positions;
    const auto moved = carve_mesh(mesh, helix_path, map).mesh;
    for (int n = 0; n < 40; ++n) {
        if (n >= 18 && n <= 27) continue;
        const auto at = static_cast<std::size_t>(n);
        const auto wanted =
            n < 18 ? positions[at] : longer.position(Vec3d(3.3 + 0.1 * (n % 7), 4.7, n + 0.4 + by));
        CHECK((moved.points[at] - wanted).length() < 1e-4);
        const auto image = std::ranges::find(points.images, at, &PointImage::source);
        REQUIRE(image != points.images.end());
        CHECK(((image->moved ? image->position : positions[at]) - wanted).length() < 1e-4);
    }
}

TEST_CASE(
    "in a closed lattice pairs move content round between their windows, wherever the planes "
    "begin") {
    // Seams far from where the planes close, and beside it.
    const auto [window, pair_window, out, in] =
        GENERATE(std::tuple(Window{10, 20}, Window{40, 50}, 14, 43),
                 std::tuple(Window{0, 6}, Window{68, 79}, 3, 72));
    // Off the middle, so that blocks of voxels lie across the plane where the lattice closes.
    const Vec3d centre(0, 3, 0);
    const auto round = ring(centre, {13, 9, 80}, path_spacing, openvdb::Vec2d(-3, -2));
    const auto value = [&](const Vec3d& at) {
        return static_cast<float>(2 + std::sin(5 * std::atan2(at.y() - centre.y(), at.x())));
    };
    const FloatGrid::ConstPtr grid =
        sampled<FloatGrid>(CoordBBox(Coord(-26, -20, -6), Coord(26, 32, 6)), path_spacing, value);
    auto pairs = no_seams(round, Axis::w);
    pairs.window = window;
    pairs.pair_window = pair_window;
    for (int n = 0; n < 4; ++n) {
        pairs.seams.push_back(straight_seam(pairs, out));
        pairs.pairs.push_back(straight_seam(pairs, in + n));
    }
    const CarveMap map(round, {std::make_shared<Seams>(pairs)}, 1, {}, std::vector{Softness{1, 0}});
    const auto got = carved<FloatGrid>(grid, round, map);
    const Mapping mapping(round);
    int stayed = 0, moved = 0;
    for (auto voxel = grid->cbeginValueOn(); voxel; ++voxel) {
        const auto place = mapping.locate(grid->indexToWorld(voxel.getCoord()));
        if (!place || place->z() < out - 9 || place->z() > in + 12) {
            ++stayed;
            REQUIRE(got->tree().getValue(voxel.getCoord()) == *voxel);
        } else if (place->z() > out + 1.5 && place->z() < in - 7 && place->x() > 1 &&
                   place->x() < 11 && place->y() > 1 && place->y() < 7) {
            ++moved;
            REQUIRE(got->tree().getValue(voxel.getCoord()) ==
                    Approx(value(mapping.position(*place + Vec3d(0, 0, 4)))).margin(0.06));
        }
    }
    CHECK(stayed > 8000);
    CHECK(moved > 500);
}
