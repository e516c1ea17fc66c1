#include "carve/lattice/lattice.h"
#include "carve/lattice/mapping.h"
#include "carve/remap/grid.h"
#include "nodes/preview/seam_lines.h"
#include "tests/support/node_bench.h"
#include "tests/support/reference_carve.h"

#include <catch2/catch.hpp>

#include <set>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

namespace {

using SeamList = std::vector<Ref<Seams>>;

/// Noise over and around a lattice that begins at the origin, every seventh voxel inactive.
template <class Grid>
typename Grid::Ptr noise(std::mt19937& random, const CoordBBox& box) {
    using T = typename Grid::ValueType;
    const auto grid = Grid::create(T(3));
    auto values = grid->getAccessor();
    for (auto at = box.begin(); at; ++at) {
        if (random() % 7 == 0) values.setValueOff(*at, T(int(random() % 1000)));
        else values.setValueOn(*at, T(int(random() % 1000)));
    }
    return grid;
}

/// `count` pairs along planes: at `first` and at `second`, entries that rise or stay as the kind
/// asks.
Seams straight_pairs(const Lattice& lattice, Axis axis, Seams::Kind kind, int first, int second,
                     int count) {
    auto out = no_seams(lattice, axis, kind);
    for (int n = 0; n < count; ++n) {
        out.seams.push_back(straight_seam(out, kind == Seams::Kind::remove ? first : first + n));
        out.pairs.push_back(straight_seam(out, kind == Seams::Kind::remove ? second + n : second));
    }
    return out;
}

}  // namespace

TEMPLATE_TEST_CASE("on the voxels, carving pairs is classical carving of both windows bit for bit",
                   "", openvdb::FloatGrid, openvdb::Int32Grid, openvdb::Vec3SGrid) {
    using T = typename TestType::ValueType;
    std::mt19937 random(9);
    for (int n = 0; n < 40; ++n) {
        std::array<int, 3> axes{0, 1, 2};
        std::ranges::shuffle(axes, random);
        const auto lattice =
            make_box(Vec3d(0), {7 + below(random, 16), 7 + below(random, 16), 1 + below(random, 9)},
                     1.0, axes);
        Layout layout{Coord(0), {}};
        for (std::size_t d = 0; d < 3; ++d) {
            layout.step[d] = Coord(0);
            layout.step[d][axes[d]] = 1;
        }
        SeamList sets;
        auto shape = lattice.shape;
        const int length = 1 + n % 3;
        for (int step = 0; step < length; ++step) {
            const auto axis = static_cast<Axis>(random() % 3);
            const auto kind = random() % 2 == 0 ? Seams::Kind::remove : Seams::Kind::insert;
            const int count = below(random, shape[static_cast<std::size_t>(axis)] / 3 + 1);
            const bool pairs = step == 0 || random() % 2 == 0;
            sets.push_back(std::make_shared<Seams>(
                pairs ? random_pairs(random, lattice, shape, axis, kind, count, {3, 4})
                      : random_seams(random, lattice, shape, axis, kind, count, {3, 4})));
            shape = sets.back()->shape_after(sets.back()->seams.size());
        }
        const auto count = sets.back()->seams.size() / (1 + random() % 2);
        const CarveMap map(lattice, sets, 4, count);
        CoordBBox box(Coord(-9),
                      Coord(9) + layout({map.reach()[0], map.reach()[1], map.reach()[2]}));
        const auto grid = noise<TestType>(random, box);
        Dense<T> want(*grid, box);
        for (const auto& set : sets)
            carve(want, layout, *set, 1, set == sets.back() ? count : set->seams.size(),
                  grid->background(), mean_voxel<TestType>);
        const auto got = carved<TestType>(grid, lattice, map);
        INFO("case " << n << ", " << length << " sets");
        CHECK(same(Dense<T>(*got, box), want));
    }
}

TEST_CASE(
    "pairs move what is between them by their count, and leave all else as it was bit for bit") {
    const auto kind = GENERATE(Seams::Kind::remove, Seams::Kind::insert);
    auto transform = openvdb::math::Transform::createLinearTransform(0.8);
    transform->preRotate(0.3, openvdb::math::Z_AXIS);
    const auto lattice = make_box(Vec3d(0), {40, 20, 8}, 0.8, {0, 1, 2});
    const auto field = [](const Vec3d& p) { return float(p.x() + 0.25 * p.y()); };
    const auto grid = dense_grid(CoordBBox(Coord(-25), Coord(60)), transform, [&](const Coord& at) {
        return field(transform->indexToWorld(at));
    });

    // Three entries from 10 on in the first window, three from 25 on in the other.
    const auto seams = straight_pairs(lattice, Axis::u, kind, 10, 25, 3);
    CHECK(seams.shape_after(3) == lattice.shape);
    const CarveMap map(lattice, {std::make_shared<Seams>(seams)}, 1, {});
    CHECK(map.steps()[0].after() == 40);
    CHECK(map.reach() == lattice.shape);
    const auto got = carved<FloatGrid>(grid, lattice, map);
    const Mapping mapping(lattice);
    int kept = 0, moved = 0;
    for (auto voxel = grid->cbeginValueOn(); voxel; ++voxel) {
        const auto p = grid->indexToWorld(voxel.getCoord());
        const auto l = mapping.locate(p);
        const float value = got->tree().getValue(voxel.getCoord());
        if (!l || l->x() <= 9 || l->x() >= 28) {
            ++kept;
            REQUIRE(value == *voxel);
        } else if (l->x() >= 16 && l->x() <= 21) {
            ++moved;
            REQUIRE(value ==
                    Approx(field(p + Vec3d(kind == Seams::Kind::remove ? 2.4 : -2.4, 0, 0)))
                        .margin(1e-4));
        }
    }
    CHECK(kept > 1000);
    CHECK(moved > 500);
    CHECK(got->activeVoxelCount() == grid->activeVoxelCount());
}

TEST_CASE("a smaller count of pairs carves the first of both windows") {
    const auto lattice = make_box(Vec3d(0), {12, 3, 3}, 1.0, {0, 1, 2});
    const auto seams =
        std::make_shared<Seams>(straight_pairs(lattice, Axis::u, Seams::Kind::remove, 2, 7, 3));
    const CarveMap map(lattice, {seams}, 1, 1);
    const auto& step = map.steps()[0];
    std::vector<int> displaced;
    for (int entry = 0; entry < 12; ++entry) displaced.push_back(step.displacement(entry, 1, 1));
    CHECK(displaced == std::vector<int>{0, 0, 2, 2, 2, 2, 2, 1, 0, 0, 0, 0});
    CHECK(step.first_moved() == 2);
    CHECK(step.last_moved() == 7);
}

TEST_CASE("pairs are drawn where they are in the lattice before carving, both of them") {
    const auto lattice = make_box(Vec3d(0), {12, 4, 4}, 1.0, {0, 1, 2});
    const auto space = openvdb::math::Transform::createLinearTransform(1);
    for (const auto kind : {Seams::Kind::remove, Seams::Kind::insert}) {
        std::set<double> places;
        for (const auto& line : seam_lines(lattice, straight_pairs(lattice, Axis::u, kind, 2, 7, 2),
                                           1, *space, View::z, 1))
            places.insert(line.from[0]);
        // Voxel n reaches from n to n + 1, and what is doubled is drawn at its upper border.
        if (kind == Seams::Kind::remove) CHECK(places == std::set<double>{2.5, 3.5, 8, 9});
        else CHECK(places == std::set<double>{3, 4, 7.5, 8.5});
    }
}
