#include "carve/remap/finish/tears.h"
#include "carve/remap/grid.h"
#include "carve/remap/voxels/carve_block.h"
#include "nodes/remap.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/node_bench.h"
#include "tests/support/reference_carve.h"
#include "tests/support/sampled.h"
#include "tests/support/wavy_seams.h"

#include <openvdb/tools/Interpolation.h>
#include <catch2/catch.hpp>

#include <set>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::BBoxd;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec2d;
using openvdb::Vec3d;

namespace {

FloatGrid::ConstPtr field_beyond(const Lattice& lattice, double voxel,
                                 const std::function<float(const Vec3d&)>& value) {
    const auto box = Mapping(lattice).world_box(
        BBoxd(Vec3d(0), Vec3d(lattice.shape[0] + 5, lattice.shape[1] - 1, lattice.shape[2])));
    return sampled<FloatGrid>(CoordBBox(Coord::floor(box.min() / voxel).offsetBy(-6),
                                        Coord::ceil(box.max() / voxel).offsetBy(6)),
                              voxel, value);
}

FloatGrid::ConstPtr carved(const FloatGrid::ConstPtr& grid, const Lattice& lattice,
                           const CarveMap& map) {
    return openvdb::GridBase::grid<FloatGrid>(
        carve_grid(grid, lattice, map, Interpolation::linear));
}

/// METHOD 4 for one seam set, voxel by voxel and column by column, straight from its definition.
class Reference {
public:
    Reference(const FloatGrid& grid, const Lattice& lattice, const Seams& seams, double fade)
        : grid_(grid),
          lattice_(lattice),
          seams_(seams),
          fade_(fade),
          mapping_(lattice, reach(lattice, seams)) {
        for (int k = 0; k < seams.shape[2]; ++k)
            for (int j = 0; j < seams.laterals(); ++j)
                columns_.push_back(originals(static_cast<std::size_t>(j + seams.laterals() * k)));
    }

    float operator()(const Coord& voxel) const {
        const float own = grid_.tree().getValue(voxel);
        const auto l = mapping_.locate(grid_.indexToWorld(voxel));
        const int axis = static_cast<int>(seams_.axis), lateral = 1 - axis;
        const int before = seams_.before(), count = static_cast<int>(seams_.seams.size());
        const bool removes = seams_.kind == Seams::Kind::remove;
        if (!l) return own;
        const double u = (*l)[axis], v = (*l)[lateral], w = l->z();
        if (u > (removes ? before : before + count) - 1) return own;
        const double s = scale(v, w), end = before - 1 + (removes ? -s : s) * count;
        if (u > end) return removes ? grid_.background() : own;

        const auto value = [&](double entry) {
            if (s < 1) entry = std::min(u + s * (entry - u), before - 1.0);
            auto source = *l;
            source[axis] = entry;
            if (source == *l) return static_cast<double>(own);
            const auto at = voxel.asVec3d() + grid_.worldToIndex(mapping_.position(source)) -
                            grid_.worldToIndex(mapping_.position(*l));
            return static_cast<double>(
                openvdb::tools::BoxSampler::sample(grid_.tree(), snapped(at)));
        };
        // An inserted entry is the mean of two.
        const auto mean = [&](double entry) {
            return 0.5 * (value(std::floor(entry)) + value(std::ceil(entry)));
        };
        const int i = static_cast<int>(u), j = static_cast<int>(v), k = static_cast<int>(w);
        double sum = 0;
        for (int n = 0; n < 4; ++n) {
            const double weight = (n & 1 ? v - j : 1 - v + j) * (n & 2 ? w - k : 1 - w + k);
            if (weight == 0) continue;
            const auto& column = columns_[static_cast<std::size_t>(
                j + (n & 1) + seams_.laterals() * ((k + (n >> 1)) % seams_.shape[2]))];
            // What a removal frees goes on as before.
            const auto m = [&, size = static_cast<int>(column.size())](int entry) {
                return entry < size ? column[static_cast<std::size_t>(entry)]
                                    : before + entry - size;
            };
            const double low = m(i), high = u == i ? low + 1 : m(i + 1), a = u - i;
            if (high - low == 1)
                sum += weight * (low == std::floor(low)
                                     ? value(u + low - i)
                                     : 0.5 * (value(u + low - i - 0.5) + value(u + low - i + 0.5)));
            else sum += weight * ((1 - a) * mean(low) + a * mean(high));
        }
        return static_cast<float>(sum);
    }

private:
    static std::array<int, 3> reach(const Lattice& lattice, const Seams& seams) {
        auto out = lattice.shape;
        if (seams.kind == Seams::Kind::insert)
            out[static_cast<std::size_t>(seams.axis)] += static_cast<int>(seams.seams.size());
        return out;
    }
    double scale(double v, double w) const {
        if (fade_ == 0) return 1;
        double rim = std::min(v, seams_.laterals() - 1 - v);
        if (!lattice_.closed) rim = std::min({rim, w, seams_.shape[2] - 1 - w});
        return std::min(1.0, rim / fade_);
    }
    std::vector<double> originals(std::size_t column) const {
        std::vector<int> left, doubled;
        for (int i = 0; i < seams_.before(); ++i) left.push_back(i);
        for (const auto& seam : seams_.seams)
            if (seams_.kind == Seams::Kind::remove) left.erase(left.begin() + seam.at[column]);
            else doubled.push_back(seam.at[column]);
        std::vector<double> out;
        for (const int i : left) {
            out.push_back(i);
            for (auto n = std::ranges::count(doubled, i); n > 0; --n) out.push_back(i + 0.5);
        }
        return out;
    }

    const FloatGrid& grid_;
    const Lattice& lattice_;
    const Seams& seams_;
    const double fade_;
    const Mapping mapping_;
    std::vector<std::vector<double>> columns_;  ///< per column the original of each carved entry
};

/// The greatest difference from the reference; voxels that it moves are counted.
double error(const FloatGrid::ConstPtr& grid, const Lattice& lattice, const Seams& seams,
             double fade, int& moved) {
    auto map = map_of(lattice, {seams});
    if (fade > 0) map.fade_rims(fade);
    const auto got = carved(grid, lattice, map);
    const Reference reference(*grid, lattice, seams, fade);
    double out = 0;
    for (auto voxel = grid->cbeginValueAll(); voxel; ++voxel) {
        if (!voxel.isVoxelValue()) continue;
        const float want = reference(voxel.getCoord());
        moved += want != *voxel;
        out = std::max<double>(out, std::abs(got->tree().getValue(voxel.getCoord()) - want));
    }
    return out;
}

Lattice turned_box() {
    return turned(make_box(Vec3d(0.1, 0.2, 0.3), {20, 17, 16}, 1.0, {0, 1, 2}), 0.4);
}

struct Warnings : Context::Host {
    std::set<std::string> all;
    void warn(const std::string& message) override { all.insert(message); }
};

}  // namespace

TEST_CASE("sampled carves, faded or cut, are what their definition says, voxel by voxel") {
    std::mt19937 random(21);
    const auto kind = GENERATE(Seams::Kind::remove, Seams::Kind::insert);
    const double fade = GENERATE(0.0, 4.0);
    for (const auto& lattice : {ring(Vec3d(0.1, 0.2, 0.3), {17, 16, 60}, 1.0, Vec2d(-6, -2)),
                                helix({16, 17, 16}, 1.0, 15, 2), turned_box()}) {
        const auto grid = field_beyond(lattice, 1.1, swirl);
        for (const auto& seams :
             {wavy_seams(lattice, Axis::u, kind, 8, 4, 2),
              random_seams(random, lattice, lattice.shape, Axis::v, kind, 5, {1})}) {
            auto closing = seams;
            closing.closed = lattice.closed;
            int moved = 0;
            INFO(lattice.description << ", " << to_text(kind) << " along " << to_text(seams.axis)
                                     << ", fade " << fade);
            CHECK(error(grid, lattice, closing, fade, moved) < 2e-5);
            CHECK(moved > 700);
        }
    }
}

TEST_CASE("many seams at one place reach further than is worth copying, and give the same") {
    const auto lattice = turned(make_box(Vec3d(0), {90, 5, 5}, 1.0, {0, 1, 2}), 0.7);
    const auto grid = field_beyond(lattice, 0.7, swirl);
    int moved = 0;
    CHECK(error(grid, lattice, wavy_seams(lattice, Axis::u, Seams::Kind::remove, 10, 70, 0), 0,
                moved) < 2e-5);
    CHECK(moved > 3000);
}

TEST_CASE(
    "components of a staggered grid are moved from their own faces, also where all moves alike") {
    const auto lattice = ring(Vec3d(0.3, 0.2, 0.1), {40, 30, 130}, 0.5, Vec2d(-5, -3));
    const std::array<Vec3d, 3> slopes{Vec3d(1, -0.5, 0.25), Vec3d(0.2, 0.7, -1),
                                      Vec3d(-0.6, 0.3, 0.4)};
    const auto value = [&](const Vec3d& at) {
        return openvdb::Vec3s(Vec3d(slopes[0].dot(at), slopes[1].dot(at), slopes[2].dot(at)));
    };
    const auto grid =
        sampled_staggered(CoordBBox(Coord(-50, -50, -12), Coord(60, 60, 36)), 0.5, value);
    const auto seams = wavy_seams(lattice, Axis::u, Seams::Kind::remove, 3, 4, 0);
    const auto got = openvdb::GridBase::grid<VectorGrid>(
        carve_grid(grid, lattice, map_of(lattice, {seams}), Interpolation::linear));
    const Mapping mapping(lattice);
    int moved = 0;
    double worst = 0;
    for (auto voxel = grid->cbeginValueAll(); voxel; ++voxel)
        for (int c = 0; c < 3 && voxel.isVoxelValue(); ++c) {
            auto face = grid->indexToWorld(voxel.getCoord());
            face[c] -= 0.25;
            const auto place = mapping.locate(face);
            if (!place || place->x() < 4 || place->x() > 35) continue;
            const double want = slopes[static_cast<std::size_t>(c)].dot(
                face + mapping.position(*place + Vec3d(4, 0, 0)) - mapping.position(*place));
            worst = std::max(worst, std::abs(got->tree().getValue(voxel.getCoord())[c] - want));
            ++moved;
        }
    CHECK(worst < 2e-5);
    CHECK(moved > 100000);
}

TEST_CASE(
    "a fade leaves the rims as they were and the inside as a cut has it, bit for bit, on the "
    "voxels too",
    "[long]") {
    const double off = GENERATE(0.0, 0.0008, 0.37);
    const auto kind = GENERATE(Seams::Kind::remove, Seams::Kind::insert);
    const auto box = make_box(Vec3d(off, 0, 0), {40, 24, 20}, 1.0, {0, 1, 2});
    for (const auto& lattice :
         {box, ring(Vec3d(0.1, 0.2, 0.3), {26, 22, 130}, 1.0, Vec2d(-5, -2))}) {
        const auto grid = field_beyond(lattice, 1.0, swirl);
        const auto seams = wavy_seams(lattice, Axis::u, kind, 9, 5, 2);
        auto map = map_of(lattice, {seams});
        const auto cut = carved(grid, lattice, map);
        map.fade_rims(4);
        const auto faded = carved(grid, lattice, map);
        const Mapping mapping(lattice, map.reach());
        int inside = 0, rim = 0, between = 0;
        for (auto voxel = grid->cbeginValueAll(); voxel; ++voxel) {
            const auto place = mapping.locate(grid->indexToWorld(voxel.getCoord()));
            if (!place || !voxel.isVoxelValue()) continue;
            const auto rim_distance = [](double x, int size) { return std::min(x, size - 1 - x); };
            double lateral = rim_distance(place->y(), lattice.shape[1]);
            if (!lattice.closed)
                lateral = std::min(lateral, rim_distance(place->z(), lattice.shape[2]));
            const float got = faded->tree().getValue(voxel.getCoord()),
                        there = cut->tree().getValue(voxel.getCoord());
            const bool on = faded->tree().isValueOn(voxel.getCoord());
            if (lateral >= 4) {
                ++inside;
                REQUIRE(got == there);
                REQUIRE(on == cut->tree().isValueOn(voxel.getCoord()));
            } else if (lateral == 0) {
                ++rim;
                REQUIRE(got == *voxel);
            } else {
                between += got != there;
            }
        }
        CHECK(inside > 3000);
        CHECK((rim > 500 || off == 0.37 || lattice.closed));
        CHECK(between > 1000);
    }
}

TEST_CASE("staggered components on the voxels travel with their voxel inside a fade") {
    const auto lattice = make_box(Vec3d(0), {30, 24, 20}, 1.0, {0, 1, 2});
    const auto grid = sampled_staggered(CoordBBox(Coord(-3), Coord(33)), 1.0, [](const Vec3d& at) {
        return openvdb::Vec3s(swirl(at), swirl(2.0 * at), swirl(0.5 * at));
    });
    auto map = map_of(lattice, {wavy_seams(lattice, Axis::u, Seams::Kind::remove, 9, 5, 2)});
    const auto cut =
        openvdb::GridBase::grid<VectorGrid>(carve_grid(grid, lattice, map, Interpolation::linear));
    map.fade_rims(4);
    const auto faded =
        openvdb::GridBase::grid<VectorGrid>(carve_grid(grid, lattice, map, Interpolation::linear));
    int differ = 0;
    for (auto at = CoordBBox(Coord(0), Coord(29, 23, 19)).begin(); at; ++at) {
        const int lateral = std::min({(*at).y(), 23 - (*at).y(), (*at).z(), 19 - (*at).z()});
        const auto got = faded->tree().getValue(*at), there = cut->tree().getValue(*at);
        // The face half a voxel below one that is 4 inside is not.
        if (lateral > 4) REQUIRE(got == there);
        else differ += got != there;
    }
    CHECK(differ > 1000);
}

TEST_CASE("a fade does not fold: what rises along the axis still does") {
    std::mt19937 random(22);
    const auto lattice = make_box(Vec3d(0), {40, 13, 13}, 1.0, {0, 1, 2});
    const FloatGrid::ConstPtr grid =
        sampled<FloatGrid>(CoordBBox(Coord(0), Coord(60, 12, 12)), 1.0,
                           [](const Vec3d& at) { return static_cast<float>(at.x()); });
    for (int n = 0; n < 9; ++n) {
        const auto kind = n % 2 ? Seams::Kind::remove : Seams::Kind::insert;
        auto map = map_of(
            lattice, {n < 6 ? random_seams(random, lattice, lattice.shape, Axis::u, kind, 9, {1})
                            : random_pairs(random, lattice, lattice.shape, Axis::u, kind, 6, {1})});
        map.fade_rims(6);
        const auto got = carved(grid, lattice, map);
        for (int j = 0; j < 13; ++j)
            for (int k = 0; k < 13; ++k) {
                float last = -1;
                const double scale = std::min({j, k, 12 - j, 12 - k}) / 6.0;
                const double end =
                    n >= 6 ? 39 : 39 + (kind == Seams::Kind::remove ? -9 : 9) * scale;
                for (int i = 0; i <= end; ++i) {
                    const float value = got->tree().getValue(Coord(i, j, k));
                    REQUIRE(value >= last - 1e-5f);
                    REQUIRE(value <= 39);
                    last = value;
                }
                if (n < 6) REQUIRE(last == Approx(39 - (end - std::floor(end))).margin(1.01));
                const int beyond = static_cast<int>(end) + 1;
                REQUIRE(got->tree().getValue(Coord(beyond, j, k)) ==
                        (n < 6 && kind == Seams::Kind::remove && beyond < 40
                             ? 0.0f
                             : static_cast<float>(beyond)));
            }
    }
}

TEST_CASE("a lattice too thin for a fade is refused") {
    const auto lattice = make_box(Vec3d(0), {40, 16, 13}, 1.0, {0, 1, 2});
    auto map = map_of(lattice, {wavy_seams(lattice, Axis::u, Seams::Kind::remove, 9, 5, 2)});
    CHECK(failure_of([&] { map.fade_rims(8); }) ==
          "a fade over 8 vertices from either rim needs 17 vertices along v, but the lattice has "
          "16; lower `rim_fade`");
    CHECK(failure_of([&] { map.fade_rims(6.5); }) ==
          "a fade over 6.5 vertices from either rim needs 14 vertices along w, but the lattice has "
          "13; lower `rim_fade`");
    map.fade_rims(6);
    const auto image = make_box(Vec3d(0), {40, 16, 1}, 1.0, {0, 1, 2});
    auto flat = map_of(image, {wavy_seams(image, Axis::u, Seams::Kind::remove, 9, 5, 2)});
    flat.fade_rims(7);
    CHECK(flat.steps()[0].rim_scale(Vec3d(3, 7, 0)) == 1);
    CHECK(NodeBench(remap_grids(), "{rim_fade: 3}").faults() ==
          "rim_fade: nothing fades while `rim` is cut; set `rim: fade`, or leave `rim_fade` out\n");
    CHECK(NodeBench(remap_grids(), "{rim: fade, rim_fade: 3}").faults().empty());
}

TEST_CASE("content on both sides of a rim is told, with its share of the rim") {
    const auto lattice = make_box(Vec3d(0), {40, 20, 16}, 1.0, {0, 1, 2});
    const auto seams = wavy_seams(lattice, Axis::u, Seams::Kind::remove, 9, 5, 0);
    const auto with = [&](const CoordBBox& box) {
        const auto grid = FloatGrid::create();
        grid->setName("smoke");
        grid->fill(box, 1.0f, true);
        Volume out;
        out.grids = {grid};
        return out;
    };
    const auto told = [](const std::vector<Tear>& tears) {
        std::map<std::string, double> out;
        for (const auto& tear : tears) out[tear.rim] = tear.share;
        return out;
    };
    auto map = map_of(lattice, {seams});
    // What moves are the carved entries 9 to 34, from the original ones 14 to 39.
    CHECK(find_tears(with(CoordBBox(Coord(0), Coord(39, 19, 15))), lattice, map).empty());
    CHECK(find_tears(with(CoordBBox(Coord(0, -5, -5), Coord(13, 25, 25))), lattice, map).empty());
    CHECK(find_tears(with(CoordBBox(Coord(0, -5, 0), Coord(39, -1, 15))), lattice, map).empty());
    const auto across_v =
        find_tears(with(CoordBBox(Coord(14, -5, 0), Coord(39, 19, 7))), lattice, map);
    CHECK(told(across_v) == std::map<std::string, double>{{"v = 0", 26.0 * 8 / (35 * 16)}});
    CHECK(told(find_tears(with(CoordBBox(Coord(30, 1, 0), Coord(45, 10, 20))), lattice, map)) ==
          std::map<std::string, double>{{"u = 39", 10.0 * 16 / (20 * 16)},
                                        {"w = 15", 10.0 * 10 / (35 * 20)}});
    REQUIRE(across_v.size() == 1);
    CHECK(to_text(across_v[0]) ==
          "grid 'smoke' crosses the lattice's rim v = 0 along more than 10 % of the rim, and only "
          "the part inside the lattice moves: it may tear there; make "
          "the lattice larger, or set `rim: fade`");

    std::mt19937 random(1);
    const auto pairs =
        random_pairs(random, lattice, lattice.shape, Axis::u, Seams::Kind::remove, 3, {1});
    CHECK(told(find_tears(with(CoordBBox(Coord(0, 1, 1), Coord(45, 10, 10))), lattice,
                          map_of(lattice, {pairs})))
              .empty());
    map.fade_rims(4);
    CHECK(find_tears(with(CoordBBox(Coord(14, -5, 0), Coord(39, 19, 7))), lattice, map).empty());
    CHECK(told(find_tears(with(CoordBBox(Coord(30, 1, 4), Coord(45, 10, 11))), lattice, map))
              .size() == 1);

    // A ring's ends are no rims, and where there is a density, nothing else counts.
    const auto around = ring(Vec3d(0), {26, 12, 60}, 1.0, Vec2d(-5, -5.5));
    const auto everywhere = [&](const std::string& name, float value) {
        const auto grid =
            field_beyond(around, 1.0, [value](const Vec3d&) { return value; })->deepCopy();
        grid->setName(name);
        return grid;
    };
    const auto in_ring =
        map_of(around, {wavy_seams(around, Axis::u, Seams::Kind::insert, 9, 5, 0)});
    Volume filled;
    filled.grids = {everywhere("shadow", 1)};
    const double moved =
        (31.0 - 11) / 31;  // the first new entry stands where its lower neighbour does
    CHECK(told(find_tears(filled, around, in_ring)) ==
          std::map<std::string, double>{{"u = 25", 1}, {"v = 0", moved}, {"v = 11", moved}});
    filled.grids.push_back(everywhere("density", 0));
    CHECK(find_tears(filled, around, in_ring).empty());
}

TEST_CASE("conserve: mass keeps the mass of what fades, to one percent") {
    const auto lattice =
        std::make_shared<Lattice>(turned(make_box(Vec3d(0), {70, 32, 32}, 1.0, {0, 1, 2}), 0.4));
    const auto kind = GENERATE(Seams::Kind::remove, Seams::Kind::insert);
    const auto seams = std::make_shared<Seams>(wavy_seams(*lattice, Axis::u, kind, 28, 3, 0));
    const auto middle = Mapping(*lattice).position(Vec3d(31, 5, 16));
    const auto around = Coord::round(middle);
    const auto grid = sampled<FloatGrid>(
        CoordBBox(around.offsetBy(-40), around.offsetBy(40)), 1.0, [&](const Vec3d& at) {
            return static_cast<float>(std::exp(-(at - middle).lengthSqr() / 162));
        });
    grid->setName("density");
    const auto volume = std::make_shared<Volume>();
    volume->grids = {grid};
    const auto mass = [&](const std::string& yaml) {
        const auto got = NodeBench(remap_grids(), yaml)
                             .run({{"source", {Payload(volume)}},
                                   {"lattice", {Payload(lattice)}},
                                   {"seams", {Payload(seams)}}})
                             .at("volume")
                             .as<Volume>();
        double sum = 0;
        for (auto voxel = openvdb::GridBase::grid<FloatGrid>(got->grids[0])->cbeginValueOn(); voxel;
             ++voxel)
            sum += *voxel;
        return sum;
    };
    const double before = mass("{count: 0}");
    CHECK(std::abs(mass("{rim: fade, rim_fade: 8, conserve: mass}") / before - 1) < 0.01);
    CHECK(std::abs(mass("{rim: fade, rim_fade: 8}") / before - 1) > 0.05);
}

TEST_CASE("remap.grids warns of tears once per rim, unless it fades") {
    const auto lattice =
        std::make_shared<Lattice>(make_box(Vec3d(0), {40, 20, 18}, 1.0, {0, 1, 2}));
    const auto seams =
        std::make_shared<Seams>(wavy_seams(*lattice, Axis::u, Seams::Kind::remove, 9, 5, 0));
    const auto grid = FloatGrid::create();
    grid->setName("density");
    grid->fill(CoordBBox(Coord(0, -5, 2), Coord(39, 10, 15)), 1.0f, true);
    const auto volume = std::make_shared<Volume>();
    volume->grids = {grid};
    const NodeBench::Inputs inputs{{"source", {Payload(volume)}},
                                   {"lattice", {Payload(lattice)}},
                                   {"seams", {Payload(seams)}}};
    const std::vector<int> frames{1};
    for (const bool fade : {false, true}) {
        Warnings warnings;
        Context context(warnings, frames);
        const auto got = NodeBench(remap_grids(), fade ? "{rim: fade, rim_fade: 5}" : "{}")
                             .run(inputs, context)
                             .at("volume")
                             .as<Volume>();
        CHECK(warnings.all.size() == (fade ? 0 : 1));
        CHECK(got->grids[0] != grid);
    }
}
