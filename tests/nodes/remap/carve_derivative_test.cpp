#include "carve/remap/finish/derivative.h"
#include "carve/remap/grid.h"
#include "carve/remap/voxels/blocks.h"
#include "nodes/remap.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/reference_carve.h"
#include "tests/support/sampled.h"
#include "tests/support/wavy_seams.h"

#include <tbb/task_arena.h>
#include <catch2/catch.hpp>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Mat3d;
using openvdb::Vec2d;
using openvdb::Vec3d;

namespace {

/// The mean of the displacements of 2n + 1 entries, of fewer at the ends, straight from the
/// definition.
double filtered(const CarveStep& step, int entry, int lateral, int k) {
    k = step.columns().closed ? (k + step.columns().slices) % step.columns().slices : k;
    const int beside = std::min({step.count(), entry, step.after() - 1 - entry});
    double content = 0;
    for (int e = entry - beside; e <= entry + beside; ++e)
        content += 0.5 * step.displacement(e, lateral, k);
    return content / (2 * beside + 1);
}

double central(const std::function<double(int)>& value, int at, int size, bool closed) {
    const int low = closed ? at - 1 : std::max(at - 1, 0),
              high = closed ? at + 1 : std::min(at + 1, size - 1);
    return low == high ? 0 : (value(high) - value(low)) / (high - low);
}

openvdb::GridBase::ConstPtr carved_by_node(const openvdb::GridBase::ConstPtr& grid,
                                           const Lattice& lattice, const std::vector<Seams>& sets,
                                           const std::string& yaml) {
    const auto volume = std::make_shared<Volume>();
    volume->grids = {grid};
    std::vector<Payload> seams;
    for (const auto& set : sets) seams.emplace_back(std::make_shared<Seams>(set));
    return NodeBench(remap_grids(), yaml)
        .run({{"source", {Payload(volume)}},
              {"lattice", {Payload(std::make_shared<Lattice>(lattice))}},
              {"seams", seams}})
        .at("volume")
        .as<Volume>()
        ->grids.at(0);
}

FloatGrid::ConstPtr as_float(const openvdb::GridBase::ConstPtr& grid) {
    return openvdb::GridBase::grid<FloatGrid>(grid);
}
VectorGrid::ConstPtr as_vectors(const openvdb::GridBase::ConstPtr& grid) {
    return openvdb::GridBase::grid<VectorGrid>(grid);
}

double content(const FloatGrid& grid) {
    double out = 0;
    for (auto voxel = grid.cbeginValueOn(); voxel; ++voxel)
        out += static_cast<double>(*voxel) * static_cast<double>(voxel.getVoxelCount());
    return out;
}

FloatGrid::Ptr blob(const Vec3d& centre, double width, double voxel) {
    const int reach = static_cast<int>(4 * width / voxel);
    const auto middle = Coord::round(centre / voxel);
    const auto out = sampled<FloatGrid>(
        CoordBBox(middle.offsetBy(-reach), middle.offsetBy(reach)), voxel, [&](const Vec3d& at) {
            return static_cast<float>(std::exp(-(at - centre).lengthSqr() / (2 * width * width)));
        });
    out->setName("density");
    return out;
}

/// Along the directions outward, up and around of a position about the z axis.
Mat3d around_z(const Vec3d& at) {
    const auto out = Vec3d(at.x(), at.y(), 0).unit();
    return {out, Vec3d(0, 0, 1), Vec3d(out.y(), -out.x(), 0), true};
}

}  // namespace

TEST_CASE(
    "displacements are filtered along the carved axis, narrower at its ends, and differ by central "
    "differences") {
    std::mt19937 random(1);
    for (int n = 0; n < 24; ++n) {
        const auto axis = n % 7 == 6 ? Axis::w : n % 2 ? Axis::u : Axis::v;
        auto lattice =
            make_box(Vec3d(0), vertex_of(axis, n % 2 ? 19 : 20, n % 2 ? 1 + n % 5 : 7, 1 + n % 4),
                     1.0, {0, 1, 2});
        lattice.closed = n % 4 == 3 && axis != Axis::w;
        lattice.hash = lattice_hash(lattice);
        const auto kind = n % 3 ? Seams::Kind::remove : Seams::Kind::insert;
        auto seams = n % 5 == 0
                         ? random_pairs(random, lattice, lattice.shape, axis, kind, 3, {1})
                         : random_seams(random, lattice, lattice.shape, axis, kind, 1 + n % 6, {1});
        seams.closed = lattice.closed;
        const auto map = map_of(lattice, {seams});
        const auto& step = map.steps()[0];
        const SmoothDisplacement smooth(step);
        for (int k = 0; k < step.columns().slices; ++k)
            for (int lateral = 0; lateral < step.columns().laterals; ++lateral)
                for (int e = 0; e < step.after(); ++e) {
                    Vec3d at(vertex_of<double>(axis, e, lateral, k).data()), gradient;
                    gradient[step.axis()] =
                        central([&](int x) { return filtered(step, x, lateral, k); }, e,
                                step.after(), false);
                    gradient[step.lateral_axis()] =
                        central([&](int x) { return filtered(step, e, x, k); }, lateral,
                                step.columns().laterals, false);
                    gradient[step.slice_axis()] =
                        central([&](int x) { return filtered(step, e, lateral, x); }, k,
                                step.columns().slices, step.columns().closed);
                    const auto got = smooth.at(at, step);
                    INFO("case " << n << ", entry " << e << ", column " << lateral << ", " << k);
                    REQUIRE(got.d == Approx(filtered(step, e, lateral, k)).margin(1e-5));
                    REQUIRE((got.gradient - gradient).length() < 1e-5);
                }
        // Between the vertices, trilinear.
        Vec3d at(0);
        at[step.axis()] = 4.25;
        const auto low = smooth.at(Vec3d(vertex_of<double>(axis, 4, 0, 0).data()), step),
                   high = smooth.at(Vec3d(vertex_of<double>(axis, 5, 0, 0).data()), step);
        CHECK(smooth.at(at, step).d == Approx(0.75 * low.d + 0.25 * high.d).margin(1e-5));
        CHECK(
            (smooth.at(at, step).gradient - (0.75 * low.gradient + 0.25 * high.gradient)).length() <
            1e-5);
    }
}

TEST_CASE("the derivative of a chain is the product of its steps', the last carve's first") {
    std::mt19937 random(2);
    const auto lattice = make_box(Vec3d(1, 2, 3), {20, 18, 9}, 0.5, {2, 0, 1});
    const auto u = wavy_seams(lattice, Axis::u, Seams::Kind::remove, 8, 4, 1);
    auto inner = lattice;
    inner.shape[0] -= 4;
    const auto v = wavy_seams(inner, Axis::v, Seams::Kind::insert, 7, 3, 1);
    const auto map = map_of(lattice, {u, v});
    const Mapping mapping(lattice, map.reach());
    const CarveDerivative derivative(mapping, map);
    const SmoothDisplacement first(map.steps()[0]), second(map.steps()[1]);
    const auto slope = [](int axis, const Vec3d& gradient) {
        auto out = Mat3d::identity();
        out.setRow(axis, out.row(axis) + gradient);
        return out;
    };
    const Mat3d axes(0., 1., 0., 0., 0., 1., 1., 0., 0.);  // columns: the directions of u, v and w
    for (int n = 0; n < 300; ++n) {
        std::uniform_real_distribution<double> unit(0, 1);
        const Vec3d at(15 * unit(random), 20 * unit(random), 8 * unit(random));
        const auto b = second.at(at, map.steps()[1]);
        const auto a = first.at(at + Vec3d(0, b.d, 0), map.steps()[0]);
        const Mat3d expected =
            axes * slope(0, a.gradient) * slope(1, b.gradient) * axes.transpose();
        const auto got = derivative(at);
        REQUIRE((got ? *got : Mat3d::identity()).eq(expected, 1e-9));
    }
    CHECK(!derivative(Vec3d(1.5, 1.5, 4)));
    CHECK(!derivative(Vec3d(17, 4, 4)));
}

TEST_CASE(
    "in a ring the derivative scales what lies around by the radius, and what lies outward by what "
    "the seams took") {
    const auto kind = GENERATE(Seams::Kind::remove, Seams::Kind::insert);
    const auto lattice = ring(Vec3d(0), {30, 7, 360}, 0.5, Vec2d(-7, -2));
    const auto map = map_of(lattice, {wavy_seams(lattice, Axis::u, kind, 12, 5, 0)});
    const Mapping mapping(lattice, map.reach());
    const CarveDerivative derivative(mapping, map);
    const auto& step = map.steps()[0];
    int counted = 0;
    for (int e = 1; e + 1 < step.after(); ++e)
        for (const double w : {0.0, 3.5, 359.25}) {
            const auto place = mapping.position({static_cast<double>(e), 3, w});
            const double radius = std::hypot(place.x(), place.y()), d = filtered(step, e, 3, 0);
            const auto got = derivative({static_cast<double>(e), 3, w});
            if (!got) {
                REQUIRE(d == 0);
                continue;
            }
            ++counted;
            const auto frame = around_z(place);
            const Mat3d turned = frame * *got * frame.transpose();
            const double outward =
                1 + central([&](int x) { return filtered(step, x, 3, 0); }, e, step.after(), false);
            REQUIRE(turned.eq(
                Mat3d(outward, 0., 0., 0., 1., 0., 0., 0., (radius + 0.5 * d) / radius), 0.012));
            REQUIRE(got->det() == Approx(outward * (radius + 0.5 * d) / radius).epsilon(1e-3));
        }
    CHECK(counted > 30);
}

TEST_CASE("conserve: mass keeps the mass of what seams pass through, to one percent", "[long]") {
    const auto kind = GENERATE(Seams::Kind::remove, Seams::Kind::insert);
    const int shape = GENERATE(0, 1, 2);
    const double voxel = shape == 1 ? 0.8 : 1;
    const auto box = make_box(Vec3d(-40, -40, -40), {100, 81, 81}, 1.0, {0, 1, 2});
    const auto lattice = shape == 0   ? box
                         : shape == 1 ? turned(box, 0.3)
                                      : ring(Vec3d(0), {100, 81, 300}, 1.0, Vec2d(-40, -40));
    const Vec3d centre = shape == 2 ? Vec3d(ring_radius(300, 1), 0, 0) : Vec3d(0);
    const auto grid = blob(centre, 9, voxel);
    const auto seams = wavy_seams(lattice, Axis::u, kind, 38, 3, 3);
    const auto plain = as_float(carved_by_node(grid, lattice, {seams}, "{}")),
               kept = as_float(carved_by_node(grid, lattice, {seams}, "{conserve: mass}"));
    CHECK(std::abs(content(*plain) / content(*grid) - 1) > 0.1);
    CHECK(content(*kept) == Approx(content(*grid)).epsilon(0.01));
    CHECK(kept->activeVoxelCount() == plain->activeVoxelCount());

    // Before the seams and as far as they are spread nothing changes; in a straight box nor does it
    // behind them.
    const auto map = map_of(lattice, {seams});
    const Mapping mapping(lattice, map.reach());
    const auto& step = map.steps()[0];
    int same = 0, differ = 0;
    for (auto value = plain->cbeginValueOn(); value; ++value) {
        const auto place = mapping.locate(plain->indexToWorld(value.getCoord()));
        const bool before = !place || place->x() < step.first_moved() - 5,
                   behind = place && shape != 2 && place->x() > 60;
        const float got = kept->tree().getValue(value.getCoord());
        if (before || behind) REQUIRE(same_bits(got, *value));
        ++(before || behind ? same : differ);
    }
    CHECK(same > 10000);
    CHECK(differ > 10000);
}

TEST_CASE("conserve scales the named densities by the determinant, and refuses what is none") {
    const auto lattice = make_box(Vec3d(0), {40, 8, 8}, 1.0, {0, 1, 2});
    const auto seams =
        std::make_shared<Seams>(wavy_seams(lattice, Axis::u, Seams::Kind::remove, 20, 3, 0));
    const auto density = sampled<FloatGrid>(CoordBBox(Coord(0), Coord(39, 7, 7)), 1.0,
                                            [](const Vec3d&) { return 2.0f; });
    density->setName("density");
    const auto heat = density->deepCopy();
    heat->setName("temperature");
    const auto fuel = openvdb::DoubleGrid::create(0);
    fuel->setName("fuel");
    fuel->tree().fill(CoordBBox(Coord(0), Coord(39, 7, 7)), 4.0, true);
    const auto count = openvdb::Int32Grid::create(0);
    count->setName("count");
    const auto volume = std::make_shared<Volume>();
    volume->grids = {density, heat, fuel, count};
    const NodeBench::Inputs inputs{{"source", {Payload(volume)}},
                                   {"lattice", {Payload(std::make_shared<Lattice>(lattice))}},
                                   {"seams", {Payload(seams)}}};
    const auto run = [&](const std::string& yaml) {
        return NodeBench(remap_grids(), yaml).run(inputs).at("volume").as<Volume>();
    };

    const auto got = run("{conserve: mass, densities: [density, fuel]}"), plain = run("{}");
    CHECK(got->grids[1]->getName() == "temperature");
    CHECK(difference(*got->grids[1].grid(), *plain->grids[1].grid()).empty());
    // Three entries are gone at 20: a seventh each from 17 to 23 on, the difference taken over two
    // entries.
    const std::vector<double> slope{0, 0, 0.5, 1, 1, 1, 1, 1, 1, 0.5, 0, 0};
    for (int n = 0; n < 12; ++n) {
        CHECK(as_float(got->grids[0])->tree().getValue({14 + n, 4, 4}) ==
              Approx(2 * (1 + 3.0 / 7 * slope[static_cast<std::size_t>(n)])));
        CHECK(static_cast<const openvdb::DoubleGrid&>(*got->grids[2].grid())
                  .tree()
                  .getValue({14 + n, 4, 4}) ==
              Approx(4 * (1 + 3.0 / 7 * slope[static_cast<std::size_t>(n)])));
    }
    CHECK(failure_of([&] { run("{conserve: mass, densities: [soot]}"); }) ==
          "there is no grid 'soot' to conserve; there are density, temperature, fuel, count: name "
          "in `densities:` those that hold amounts per volume");
    CHECK(failure_of([&] {
              run("{conserve: mass, densities: [count]}");
          }).find("grid 'count' is no density") == 0);
    density->setGridClass(openvdb::GRID_LEVEL_SET);
    CHECK(failure_of([&] { run("{conserve: mass}"); }).find("grid 'density' is no density") == 0);
}

TEST_CASE(
    "turned with the space around them, velocities of a rotation about a ring's axis stay those of "
    "that rotation") {
    const auto kind = GENERATE(Seams::Kind::remove, Seams::Kind::insert);
    const bool staggered = GENERATE(false, true);
    const auto lattice = ring(Vec3d(0), {40, 9, 300}, 0.5, Vec2d(-10, -2));
    const int spread = 6, entry = 14;
    const auto seams = wavy_seams(lattice, Axis::u, kind, entry, 4, 0);
    const double rig = ring_radius(300, 0.5);
    const CoordBBox box(Coord(0, 0, -4), Coord(100, 100, 5));
    const auto spin = [](const Vec3d& at) { return rotation(Vec3d(0, 0, 0.1), at); };
    const auto grid =
        staggered ? sampled_staggered(box, 0.5, spin) : sampled<VectorGrid>(box, 0.5, spin);
    const auto plain = as_vectors(carved_by_node(grid, lattice, {seams}, "{}")),
               got =
                   as_vectors(carved_by_node(grid, lattice, {seams}, "{transform_vectors: true}"));
    const auto map = map_of(lattice, {seams});
    const Mapping mapping(lattice, map.reach());
    int beyond = 0, before = 0, at_seam = 0;
    double off = 0;
    for (auto voxel = grid->cbeginValueOn(); voxel; ++voxel) {
        const auto at = voxel.getCoord();
        const auto place = mapping.locate(grid->indexToWorld(at));
        // Away from the rims, where carved and other voxels are neighbours, and from the box's
        // sides.
        if (!place || place->x() > map.steps()[0].after() - 3 || at.x() < 4 || at.y() < 4 ||
            place->y() < 1 || place->y() > 7)
            continue;
        const auto value = got->tree().getValue(at), was = plain->tree().getValue(at);
        const bool near = place->x() > entry - spread &&
                          place->x() < entry + spread + (kind == Seams::Kind::insert ? 5 : 0);
        if (place->x() < entry - spread - 2) {
            ++before;
            REQUIRE(same_bits(value, was));
        } else if (near) {
            ++at_seam;
            // There the value comes from up to two vertices, 1 world unit, off the place for which
            // the derivative holds.
            REQUIRE((value - *voxel).length() < 0.1 * 1.05);
        } else {
            ++beyond;
            REQUIRE((value - *voxel).length() < 2e-3 * voxel->length());
            off = std::max<double>(off, (was - *voxel).length() / voxel->length());
        }
    }
    CHECK(beyond > 1000);
    CHECK(before > 1000);
    CHECK(at_seam > 1000);
    CHECK(off > 1.5 / rig);
}

TEST_CASE(
    "a stretching flow is carved into one that flows through the carved space, staggered and in "
    "three parts too") {
    const auto lattice = make_box(Vec3d(0), {40, 16, 10}, 1.0, {0, 1, 2});
    const auto seams = wavy_seams(lattice, Axis::u, Seams::Kind::remove, 18, 4, 2);
    const auto map = map_of(lattice, {seams});
    const auto& step = map.steps()[0];
    const auto stretch = [](const Vec3d& at) {
        return openvdb::Vec3s(static_cast<float>(at.x() - 10), static_cast<float>(0.5 * at.y()), 3);
    };
    const CoordBBox box(Coord(0), Coord(39, 15, 9));
    const auto collocated = sampled<VectorGrid>(box, 1.0, stretch),
               staggered = sampled_staggered(box, 1.0, stretch);

    const auto expected = [&](const Coord& at, const Vec3d& value) {
        Vec3d gradient(
            central([&](int x) { return filtered(step, x, at.y(), at.z()); }, at.x(), step.after(),
                    false),
            central([&](int x) { return filtered(step, at.x(), x, at.z()); }, at.y(), 16, false),
            central([&](int x) { return filtered(step, at.x(), at.y(), x); }, at.z(), 10, false));
        return Vec3d(
            (value.x() - gradient.y() * value.y() - gradient.z() * value.z()) / (1 + gradient.x()),
            value.y(), value.z());
    };
    const auto carved_at = [](const VectorGrid& grid, const Coord& at) {
        return Vec3d(grid.tree().getValue(at));
    };

    const auto plain = as_vectors(carved_by_node(collocated, lattice, {seams}, "{}")),
               got = as_vectors(
                   carved_by_node(collocated, lattice, {seams}, "{transform_vectors: true}"));
    const auto faces = as_vectors(carved_by_node(staggered, lattice, {seams}, "{}")),
               got_faces = as_vectors(
                   carved_by_node(staggered, lattice, {seams}, "{transform_vectors: true}"));
    int changed = 0;
    for (auto each = CoordBBox(Coord(1), Coord(34, 14, 8)).begin(); each; ++each) {
        const auto at = *each;
        REQUIRE((carved_at(*got, at) - expected(at, carved_at(*plain, at))).length() < 1e-4);
        changed += got->tree().getValue(at) != plain->tree().getValue(at);
        // Of a stretch along y and a constant z the four faces beside one of x have a mean that is
        // easily told.
        const auto mean = [&](int c) {
            const auto to = c == 1 ? Coord(0, 1, 0) : Coord(0, 0, 1), back = Coord(-1, 0, 0);
            return 0.25 * (carved_at(*faces, at)[c] + carved_at(*faces, at + to)[c] +
                           carved_at(*faces, at + back)[c] + carved_at(*faces, at + to + back)[c]);
        };
        const auto value = carved_at(*faces, at);
        REQUIRE(carved_at(*got_faces, at).x() ==
                Approx(expected(at, Vec3d(value.x(), mean(1), mean(2))).x()).margin(1e-4));
        REQUIRE(carved_at(*got_faces, at).y() == value.y());
    }
    CHECK(changed > 1000);

    // Houdini's three grids become what the one grid becomes.
    Volume parts;
    for (int c = 0; c < 3; ++c) {
        const auto part = FloatGrid::create();
        part->setTransform(staggered->transform().copy());
        Vec3d half(0);
        half[c] = -0.5;
        part->transform().preTranslate(half);
        part->setName(std::string("vel.") + "xyz"[c]);
        for (auto voxel = staggered->cbeginValueOn(); voxel; ++voxel)
            part->tree().setValue(voxel.getCoord(), (*voxel)[c]);
        parts.grids.push_back(part);
    }
    const auto out = NodeBench(remap_grids(), "{transform_vectors: true}")
                         .run({{"source", {Payload(std::make_shared<Volume>(parts))}},
                               {"lattice", {Payload(std::make_shared<Lattice>(lattice))}},
                               {"seams", {Payload(std::make_shared<Seams>(seams))}}})
                         .at("volume")
                         .as<Volume>();
    for (int c = 0; c < 3; ++c) {
        const auto& part =
            static_cast<const FloatGrid&>(*out->grids[static_cast<std::size_t>(c)].grid());
        CHECK(part.getName() == parts.grids[static_cast<std::size_t>(c)]->getName());
        CHECK(part.transform() == parts.grids[static_cast<std::size_t>(c)]->transform());
        for (auto at = box.begin(); at; ++at) {
            REQUIRE(part.tree().getValue(*at) == got_faces->tree().getValue(*at)[c]);
            REQUIRE(part.tree().isValueOn(*at) == got_faces->tree().isValueOn(*at));
        }
    }
}

TEST_CASE("without seams a volume comes back itself, whatever else is asked for") {
    const auto lattice = ring(Vec3d(0), {9, 7, 40}, 0.5, Vec2d(-2, -1));
    const auto volume = std::make_shared<Volume>();
    volume->grids = {blob(Vec3d(4, 0, 0), 1, 0.5), VectorGrid::create()};
    const auto out =
        NodeBench(remap_grids(),
                  "{renormalize: true, conserve: mass, transform_vectors: true, count: 0}")
            .run({{"source", {Payload(volume)}},
                  {"lattice", {Payload(std::make_shared<Lattice>(lattice))}},
                  {"seams",
                   {Payload(std::make_shared<Seams>(
                       wavy_seams(lattice, Axis::u, Seams::Kind::remove, 4, 2, 0)))}}})
            .at("volume")
            .as<Volume>();
    CHECK(out == volume);
}

TEST_CASE("mass and vectors do not depend on the number of threads") {
    const auto lattice = ring(Vec3d(0), {18, 10, 90}, 0.5, Vec2d(-4, -2));
    const auto seams = wavy_seams(lattice, Axis::u, Seams::Kind::remove, 7, 5, 2);
    const auto spin =
        sampled<VectorGrid>(CoordBBox(Coord(-30, -30, -6), Coord(30, 30, 6)), 0.5,
                            [](const Vec3d& at) { return rotation(Vec3d(0, 1, 2), at); });
    const auto smoke = blob(Vec3d(7, 0, 0), 1.5, 0.5);
    for (const auto& grid :
         {openvdb::GridBase::ConstPtr(spin), openvdb::GridBase::ConstPtr(smoke)}) {
        const std::string yaml = grid == smoke ? "{conserve: mass}" : "{transform_vectors: true}";
        openvdb::GridBase::ConstPtr one, four;
        tbb::task_arena(1).execute([&] { one = carved_by_node(grid, lattice, {seams}, yaml); });
        tbb::task_arena(4).execute([&] { four = carved_by_node(grid, lattice, {seams}, yaml); });
        CHECK(difference(*one, *four).empty());
        CHECK(!difference(*one, *carved_by_node(grid, lattice, {seams}, "{}")).empty());
    }
}
