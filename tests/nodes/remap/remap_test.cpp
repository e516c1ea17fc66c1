#include "nodes/remap.h"
#include "carve/lattice/alignment.h"
#include "carve/lattice/lattice.h"
#include "carve/remap/grid.h"
#include "carve/stream/raw_grid.h"
#include "tests/nodes/remap/remap_cases.h"
#include "tests/support/node_bench.h"
#include "tests/support/reference_carve.h"
#include "tests/support/warped.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

namespace {

using SeamList = std::vector<Ref<Seams>>;

template <class T>
T random_value(std::mt19937& random) {
    if constexpr (std::is_same_v<T, bool>) return random() % 2 == 0;
    else if constexpr (openvdb::VecTraits<T>::IsVec)
        return T(static_cast<int>(random() % 1000), static_cast<int>(random() % 1000),
                 static_cast<int>(random() % 1000));
    else return T(random() % 1000) / T(std::is_floating_point_v<T> ? 7 : 1);
}

/// Leaves, tiles of both states, and stray voxels around the origin.
template <class Grid>
typename Grid::Ptr random_grid(std::mt19937& random) {
    using T = typename Grid::ValueType;
    const auto grid =
        Grid::create(std::is_same_v<T, bool> ? openvdb::zeroVal<T>() : random_value<T>(random));
    grid->setName("random");
    auto& tree = grid->tree();
    constexpr bool mask = std::is_same_v<typename Grid::BuildType, openvdb::ValueMask>;
    for (int n = 0; n < 12; ++n) {
        const Coord at(below(random, 80) - 40, below(random, 80) - 40, below(random, 80) - 40);
        const T value = mask ? T(true) : random_value<T>(random);
        tree.addTile(n == 0 ? 2 : 1, at, value, mask || random() % 2 == 0);
    }
    for (int n = 0; n < 6; ++n) {
        const Coord low(below(random, 48) - 24, below(random, 48) - 24, below(random, 48) - 24);
        for (auto at = CoordBBox::createCube(low, 5 + below(random, 12)).begin(); at; ++at)
            if (random() % 8 != 0) tree.setValueOn(*at, mask ? T(true) : random_value<T>(random));
    }
    return grid;
}

/// A lattice on the voxels of a grid, mirrored and turned by quarters as it likes, and where its
/// vertices are.
struct OnVoxels {
    Lattice lattice;
    Layout layout;
    openvdb::math::Transform::Ptr transform;

    explicit OnVoxels(std::mt19937& random) {
        std::array<int, 3> axes{0, 1, 2};
        std::ranges::shuffle(axes, random);
        std::array<int, 3> shape{6 + below(random, 25), 6 + below(random, 25),
                                 1 + below(random, 12)};
        const double voxel = random() % 2 == 0 ? 0.25 : 0.1;
        const Vec3d sign(random() % 4 == 0 ? -1 : 1, random() % 4 == 0 ? -1 : 1, 1);
        auto matrix = openvdb::Mat4d::identity();
        for (int n = 0; n < 3; ++n) {
            matrix(n, n) = voxel * sign[n];
            matrix(3, n) = 0.37 * n;
        }
        transform = openvdb::math::Transform::createLinearTransform(matrix);
        layout.origin =
            Coord(below(random, 40) - 30, below(random, 40) - 30, below(random, 40) - 30);
        for (std::size_t n = 0; n < 3; ++n) {
            layout.step[n] = Coord(0);
            layout.step[n][axes[n]] = static_cast<int>(sign[axes[n]]);
        }
        lattice = make_box(transform->indexToWorld(layout.origin), shape, voxel, axes);
    }
};

/// All voxels that carving may change, and a rim around them.
CoordBBox around(const Layout& layout, const std::array<int, 3>& reach) {
    CoordBBox out(layout.origin, layout.origin);
    out.expand(layout({reach[0] - 1, reach[1] - 1, reach[2] - 1}));
    out.expand(9);
    return out;
}

}  // namespace

TEMPLATE_TEST_CASE("on the voxels, carving is classical seam carving bit for bit", "",
                   openvdb::FloatGrid, openvdb::DoubleGrid, openvdb::Int32Grid, openvdb::Int64Grid,
                   openvdb::BoolGrid, openvdb::MaskGrid, openvdb::Vec3SGrid, openvdb::Vec3DGrid,
                   openvdb::Vec3IGrid) {
    using T = typename TestType::ValueType;
    std::mt19937 random(7);
    for (int n = 0; n < 12; ++n) {
        const OnVoxels place(random);
        const auto grid = random_grid<TestType>(random);
        grid->setTransform(place.transform);
        if (openvdb::VecTraits<T>::IsVec) grid->setGridClass(openvdb::GRID_STAGGERED);

        SeamList sets;
        auto shape = place.lattice.shape;
        const int length = 1 + n % 3;
        for (int step = 0; step < length; ++step) {
            const auto axis = static_cast<Axis>(random() % (shape[2] > 2 ? 3 : 2));
            const int room = shape[dimension(axis)];
            const auto kind = random() % 2 == 0 ? Seams::Kind::remove : Seams::Kind::insert;
            sets.push_back(std::make_shared<Seams>(
                random_seams(random, place.lattice, shape, axis, kind,
                             below(random, std::min(room - 1, 12)), {3, 4})));
            shape = sets.back()->shape_after(sets.back()->seams.size());
        }
        const auto count = sets.back()->seams.size() / (1 + random() % 2);
        const CarveMap map(place.lattice, sets, 4, count);
        const auto box = around(place.layout, map.reach());
        Dense<T> want(*grid, box);
        for (const auto& set : sets)
            carve(want, place.layout, *set, 1, set == sets.back() ? count : set->seams.size(),
                  grid->background(), mean_voxel<TestType>);

        const auto got = carved<TestType>(grid, place.lattice, map);
        INFO("case " << n << ", " << length << " sets");
        CHECK(same(Dense<T>(*got, box), want));
        CHECK(got->getName() == "random");
        CHECK(got->transform() == grid->transform());
        CHECK(got->getGridClass() == grid->getGridClass());
    }
}

TEST_CASE("without seams, and where seams change nothing, the grid itself comes back") {
    std::mt19937 random(1);
    const OnVoxels place(random);
    const auto grid = random_grid<FloatGrid>(random);
    grid->setTransform(place.transform);
    CHECK(carve_grid(grid, place.lattice,
                     map_of_count(place.lattice,
                                  straight_seams(place.lattice, Axis::u, Seams::Kind::remove, {})),
                     Interpolation::linear) == grid);
    CHECK(carve_grid(
              grid, place.lattice,
              map_of_count(place.lattice,
                           straight_seams(place.lattice, Axis::u, Seams::Kind::remove, {2, 3}), 0),
              Interpolation::linear) == grid);

    const FloatGrid::ConstPtr flat = FloatGrid::create(0.5f);
    const auto map = map_of_count(
        place.lattice, straight_seams(place.lattice, Axis::v, Seams::Kind::insert, {2, 3}));
    CHECK(carve_grid(flat, place.lattice, map, Interpolation::linear) == flat);
}

TEST_CASE("tiles that nothing changes stay tiles") {
    const auto lattice = make_box(Vec3d(0), {256, 256, 256}, 1.0, {0, 1, 2});
    const auto grid = FloatGrid::create();
    grid->tree().addTile(2, Coord(0, 0, 0), 2.0f, true);
    grid->tree().addTile(2, Coord(0, 128, 0), 3.0f, false);
    const auto map =
        map_of_count(lattice, straight_seams(lattice, Axis::u, Seams::Kind::remove, {40, 41, 42}));
    const auto got = carved<FloatGrid>(grid, lattice, map);
    // Only the ends of the two tiles along u move, by three voxels: a layer of 16 x 16 blocks each.
    CHECK(got->tree().leafCount() == 2 * 16 * 16);
    CHECK(got->activeVoxelCount() == 125u * 128 * 128);
    CHECK(got->tree().getValue(Coord(124, 5, 5)) == 2.0f);
    CHECK(got->tree().getValue(Coord(125, 5, 5)) == 0.0f);
    CHECK(got->tree().getValue(Coord(124, 130, 5)) == 3.0f);

    const auto emptied = carved<FloatGrid>(
        grid, lattice,
        map_of_count(lattice, straight_seams(lattice, Axis::u, Seams::Kind::remove,
                                             std::vector<int>(256, 0))));
    CHECK(emptied->tree().leafCount() == 0);
    CHECK(emptied->activeVoxelCount() == 0);
}

TEST_CASE("leaves and tiles of all levels that lie beside the lattice stay as they were") {
    const auto lattice = make_box(Vec3d(0), {8, 8, 8}, 1.0, {0, 1, 2});
    const auto grid = dense_grid(CoordBBox(Coord(0), Coord(7)),
                                 openvdb::math::Transform::createLinearTransform(1.0),
                                 [](const Coord& at) { return float(at.x()); });
    auto& tree = grid->tree();
    for (const bool on : {true, false}) {
        const int y = on ? 0 : 64;
        tree.setValueOn({40, y, 0}, 1.0f);
        tree.addTile(1, {64, y, 0}, 2.0f, on);
        tree.addTile(2, {128, 2 * y, 0}, 3.0f, on);
        tree.addTile(3, {4096, 64 * y, 0}, 4.0f, on);
    }
    const auto got = carved<FloatGrid>(
        grid, lattice,
        map_of_count(lattice, straight_seams(lattice, Axis::u, Seams::Kind::remove, {3})));
    REQUIRE(got != grid);
    for (const int y : {0, 64})
        for (const Coord& at : {Coord(40, y, 0), Coord(41, y, 0), Coord(64, y, 0),
                                Coord(128, 2 * y, 0), Coord(4096, 64 * y, 0)}) {
            INFO(at);
            CHECK(got->tree().getValue(at) == tree.getValue(at));
            CHECK(got->tree().isValueOn(at) == tree.isValueOn(at));
            CHECK(got->tree().getValueDepth(at) == tree.getValueDepth(at));
        }
}

TEST_CASE("an output keeps all metadata of its grid, the half flag too") {
    const auto lattice = make_box(Vec3d(0), {8, 8, 8}, 1.0, {0, 1, 2});
    const auto grid = dense_grid(CoordBBox(Coord(0), Coord(7)),
                                 openvdb::math::Transform::createLinearTransform(1.0),
                                 [](const Coord& at) { return float(at.x()); });
    grid->setSaveFloatAsHalf(true);
    grid->insertMeta("of the house", openvdb::StringMetadata("yes"));
    const auto got = carved<FloatGrid>(
        grid, lattice,
        map_of_count(lattice, straight_seams(lattice, Axis::u, Seams::Kind::remove, {3})));
    CHECK(got != grid);
    CHECK(got->saveFloatAsHalf());
    CHECK(got->metaValue<std::string>("of the house") == "yes");
    CHECK(grid->tree().getValue(Coord(3, 0, 0)) == 3.0f);
    CHECK(got->tree().getValue(Coord(3, 0, 0)) == 4.0f);
}

TEST_CASE("between the voxels, a linear field is carved without error") {
    // Vertices stand between the voxels, then twice as dense as they, then turned about an axis.
    const int variant = GENERATE(0, 1, 2);
    const auto interpolation =
        GENERATE(Interpolation::linear, Interpolation::quadratic, Interpolation::cubic);
    auto transform = openvdb::math::Transform::createLinearTransform(variant == 1 ? 0.5 : 0.25);
    if (variant == 0) transform->postTranslate(Vec3d(0.125, 0.125, 0.05));
    if (variant == 2) transform->preRotate(0.3, openvdb::math::Z_AXIS);
    const Vec3d slope(1, -0.5, 0.25);
    const auto grid = dense_grid(CoordBBox(Coord(-12), Coord(24)), transform, [&](const Coord& at) {
        return float(slope.dot(transform->indexToWorld(at)));
    });
    const auto lattice = make_box(Vec3d(0), {13, 9, 7}, 0.25, {0, 1, 2});
    const auto map =
        map_of_count(lattice, straight_seams(lattice, Axis::u, Seams::Kind::remove, {5, 5}));
    const auto got = carved<FloatGrid>(grid, lattice, map, interpolation);

    const Mapping mapping(lattice);
    int moved = 0, kept = 0, freed = 0;
    for (auto voxel = grid->cbeginValueOn(); voxel; ++voxel) {
        const auto p = grid->indexToWorld(voxel.getCoord());
        const auto l = mapping.locate(p);
        const float value = got->tree().getValue(voxel.getCoord());
        if (!l || l->x() <= 4) {
            ++kept;
            CHECK(value == *voxel);
        } else if (l->x() > 10) {
            ++freed;
            CHECK(value == 0.0f);
            CHECK(!got->tree().isValueOn(voxel.getCoord()));
        } else {
            ++moved;
            const double shift =
                l->x() >= 5 ? 2
                            : 2 * (l->x() - 4);  // values are interpolated across the seam's cell
            CHECK(value == Approx(slope.dot(p + Vec3d(0.25 * shift, 0, 0))).margin(1e-4));
        }
    }
    CHECK(kept > 1000);
    CHECK(moved > 20);
    CHECK(freed > 10);
}

TEST_CASE("a step that is removed in a turned lattice does not shine through") {
    auto transform = openvdb::math::Transform::createLinearTransform(1.0);
    transform->preRotate(7 * M_PI / 180, openvdb::math::Z_AXIS);
    const auto lattice = make_box(Vec3d(0), {40, 30, 6}, 1.0, {0, 1, 2});
    const Mapping mapping(lattice);
    // A bar, ten wide and soft at its rims: gone if all of it is removed.
    const auto grid = dense_grid(CoordBBox(Coord(-20), Coord(60)), transform, [&](const Coord& at) {
        const double u = transform->indexToWorld(at).x();
        return u > 14.5 && u < 24.5 ? 1.0f : 0.0f;
    });
    const auto map = map_of_count(
        lattice, straight_seams(lattice, Axis::u, Seams::Kind::remove, std::vector<int>(12, 13)));
    const auto got = carved<FloatGrid>(grid, lattice, map);
    int shining = 0;
    for (auto voxel = got->cbeginValueOn(); voxel; ++voxel)
        if (const auto l = mapping.locate(got->indexToWorld(voxel.getCoord())); l && l->x() < 27)
            shining += *voxel > 0.5f;
    CHECK(shining == 0);
}

TEST_CASE("a freed end is cleared inside a tile, between the voxels too") {
    const auto grid = FloatGrid::create();
    grid->tree().addTile(2, Coord(0), 2.0f, true);
    const auto lattice = make_box(Vec3d(0.5, 0.5, 0.5), {120, 120, 120}, 1.0, {0, 1, 2});
    const auto got = carved<FloatGrid>(
        grid, lattice,
        map_of_count(lattice, straight_seams(lattice, Axis::u, Seams::Kind::remove,
                                             std::vector<int>(10, 40))));
    CHECK(got->tree().getValue(Coord(109, 60, 60)) == 2.0f);
    CHECK(got->tree().getValue(Coord(110, 60, 60)) == 0.0f);
    CHECK(got->tree().getValue(Coord(119, 60, 60)) == 0.0f);
    CHECK(got->tree().getValue(Coord(120, 60, 60)) == 2.0f);
    CHECK(got->activeVoxelCount() == 128u * 128 * 128 - 10u * 119 * 119);
    CHECK(got->tree().leafCount() < 1000);
}

TEST_CASE("sampling where vertices are voxels gives what copying gives") {
    std::mt19937 random(5);
    for (int n = 0; n < 10; ++n) {
        const OnVoxels place(random);
        const auto grid = random_grid<FloatGrid>(random);
        grid->setTransform(place.transform);
        SeamList sets;
        sets.push_back(std::make_shared<Seams>(
            random_seams(random, place.lattice, place.lattice.shape, Axis::u,
                         n % 2 ? Seams::Kind::remove : Seams::Kind::insert, 1 + n % 5, {1})));
        sets.push_back(std::make_shared<Seams>(
            random_seams(random, place.lattice, sets[0]->shape_after(sets[0]->seams.size()),
                         Axis::v, n % 3 ? Seams::Kind::remove : Seams::Kind::insert, 2, {1})));
        const CarveMap map(place.lattice, sets, 1, {});
        const auto copied = carved<FloatGrid>(grid, place.lattice, map);
        const auto sampled = carve_sampled<FloatGrid>(grid, Mapping(place.lattice, map.reach()),
                                                      map, Interpolation::cubic);
        const auto box = around(place.layout, map.reach());
        const Dense<float> a(*copied, box), b(*sampled, box);
        INFO("case " << n);
        bool equal = true;
        for (std::size_t v = 0; v < a.voxels.size(); ++v)
            equal = equal && std::abs(a.voxels[v].value - b.voxels[v].value) <= 1e-4f &&
                    a.voxels[v].on == b.voxels[v].on;
        CHECK(equal);
    }
}

TEMPLATE_TEST_CASE(
    "softly carved on the voxels, components of a staggered grid move from their faces as where "
    "the grid is sampled",
    "", openvdb::Vec3SGrid, openvdb::Vec3DGrid) {
    using T = typename TestType::ValueType;
    std::mt19937 random(9);
    int moved = 0;
    for (int n = 0; n < 40; ++n) {
        const OnVoxels place(random);
        const auto grid = random_grid<TestType>(random);
        grid->setTransform(place.transform);
        grid->setGridClass(openvdb::GRID_STAGGERED);
        const auto axis = n % 3 == 2 && place.lattice.shape[2] > 6 ? Axis::w
                          : n % 2                                  ? Axis::u
                                                                   : Axis::v;
        auto seams =
            random_seams(random, place.lattice, place.lattice.shape, axis,
                         n % 4 < 2 ? Seams::Kind::remove : Seams::Kind::insert, 1 + n % 5, {1});
        if (n % 3 == 0) {
            seams.anchor = {Anchor::At::high, 0};
            seams.find_shifts();
        }
        if (n % 6 == 1)
            seams = warped(
                place.lattice,
                [](int entry, int lateral, int k, int) {
                    return 0.2 * entry + 0.3 * std::sin(0.4 * lateral + k);
                },
                axis);
        const CarveMap map(place.lattice, {std::make_shared<Seams>(seams)}, 1, {},
                           std::vector{Softness{0.7 + n % 3, 0}});
        const auto lattice =
            on_voxels(map.extended(place.lattice),
                      *align(map.extended(place.lattice), *place.transform), *place.transform);
        const auto by_lines = carved<TestType>(grid, place.lattice, map);
        const auto sampled = carve_sampled<TestType>(grid, Mapping(lattice, map.reach()), map,
                                                     Interpolation::linear);
        const auto box = around(place.layout, map.reach());
        const Dense<T> before(*grid, box), a(*by_lines, box), b(*sampled, box);
        INFO("case " << n);
        int different = 0;
        for (std::size_t v = 0; v < a.voxels.size(); ++v) {
            moved += a.voxels[v].value != before.voxels[v].value;
            different += (a.voxels[v].value - b.voxels[v].value).length() > 0.01 ||
                         a.voxels[v].on != b.voxels[v].on;
        }
        CHECK(different == 0);
    }
    CHECK(moved > 3900);
}

TEST_CASE("a face at the end of what a warp leaves comes from the two faces around its place") {
    const auto lattice = make_box(Vec3d(1, 0, 0), {42, 6, 6}, 1.0, {0, 1, 2});
    const auto grid = openvdb::Vec3SGrid::create();
    grid->setGridClass(openvdb::GRID_STAGGERED);
    for (const auto& at : CoordBBox(Coord(-5, -2, -2), Coord(55, 8, 8)))
        grid->tree().setValueOn(at, openvdb::Vec3s(static_cast<float>(at.x()), 2, 3));
    const auto warp = warped(lattice, [](int entry, int, int, int) {
        return std::clamp(0.2 * (20 - entry), -4.0, 4.0);
    });
    const CarveMap map(lattice, {std::make_shared<Seams>(warp)}, 1, {},
                       std::vector{Softness{1, 0}});
    const auto out = carved<openvdb::Vec3SGrid>(grid, lattice, map);
    // Vertex 37 holds what vertex 41, the last one, had. So does the face behind it, which has no
    // place in the lattice to come from.
    CHECK(out->tree().getValue(Coord(38, 3, 3)).x() == 42);
    CHECK(out->tree().getValue(Coord(39, 3, 3)).x() == 42.5f);
}
