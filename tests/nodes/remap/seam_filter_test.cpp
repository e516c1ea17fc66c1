#include "carve/remap/seam_filter.h"
#include "carve/lattice/alignment.h"
#include "carve/lattice/mapping.h"
#include "carve/remap/grid.h"
#include "nodes/filter.h"
#include "nodes/remap.h"
#include "tests/support/bent_lattices.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/node_bench.h"
#include "tests/support/reference_carve.h"
#include "tests/support/sampled.h"
#include "tests/support/wavy_seams.h"

#include <tbb/task_arena.h>
#include <catch2/catch.hpp>

#include <limits>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec2d;
using openvdb::Vec3d;

namespace {

/// How the vertices of a set's carved space are displaced, by carving their own numbers.
class Displacements {
public:
    explicit Displacements(const Seams& seams, std::size_t t = 0)
        : axis_(static_cast<int>(seams.axis)),
          closed_(seams.closed),
          left_(seams.shape_after(seams.seams.size())),
          reach_(left_),
          numbers_(FloatGrid(), CoordBBox(Coord(0), Coord(0))) {
        auto& along = reach_[static_cast<std::size_t>(axis_)];
        along = std::max(along, seams.before());
        FloatGrid grid;
        const CoordBBox box(Coord(0), Coord(reach_[0] - 1, reach_[1] - 1, reach_[2] - 1));
        for (auto at = box.begin(); at; ++at)
            grid.tree().setValue(*at, static_cast<float>((*at)[axis_]));
        numbers_ = Dense<float>(grid, box);
        using Voxel = Dense<float>::Voxel;
        carve(numbers_, Layout{}, seams, t, seams.seams.size(), -1.0f,
              [](const Voxel& a, const Voxel& b) {
                  return Voxel{(a.value + b.value) / 2, true};
              });
    }

    enum class Cell { beside, freed, whole, divided };
    /// What all cells are that a point touches; where they are whole, it goes to where it came
    /// from.
    Cell follow(Vec3d& at) {
        for (const int n : {axis_, 1 - axis_})
            if (at[n] < 0 || at[n] > reach_[static_cast<std::size_t>(n)] - 1) return Cell::beside;
        if (at[axis_] > left_[static_cast<std::size_t>(axis_)] - 1) return Cell::freed;
        const CoordBBox corners(Coord::ceil(at).offsetBy(-1), Coord::floor(at).offsetBy(1));
        std::optional<float> common;
        for (auto corner = corners.begin(); corner; ++corner) {
            auto vertex = *corner;
            if (closed_) vertex.z() = (vertex.z() + left_[2]) % left_[2];
            if (!CoordBBox(Coord(0), Coord(left_[0] - 1, left_[1] - 1, left_[2] - 1))
                     .isInside(vertex))
                continue;
            const float d = numbers_.at(vertex).value - static_cast<float>(vertex[axis_]);
            if (common.value_or(d) != d) return Cell::divided;
            common = d;
        }
        at[axis_] += *common;
        return Cell::whole;
    }

private:
    int axis_;
    bool closed_;
    std::array<int, 3> left_, reach_;
    Dense<float> numbers_;
};

bool along_any(std::vector<Displacements>& sets, Vec3d at) {
    for (auto set = sets.rbegin(); set != sets.rend(); ++set) {
        const auto cell = set->follow(at);
        if (cell == Displacements::Cell::divided) return true;
        if (cell == Displacements::Cell::freed) return false;
    }
    return false;
}

template <class Grid>
typename Grid::ConstPtr filtered(const typename Grid::ConstPtr& grid, const Lattice& lattice,
                                 const CarveMap& map, FilterMode mode, int width) {
    return openvdb::GridBase::grid<Grid>(
        seam_filtered(volume_of(grid), lattice, map, mode, width).grids.at(0));
}

/// Noise, active in all of a box.
FloatGrid::Ptr noise(std::mt19937& random, const CoordBBox& box, double voxel = 1) {
    return sampled<FloatGrid>(
        box, voxel, [&](const Vec3d&) { return static_cast<float>(random() % 1000) / 7; });
}

/// Two seams that step aside in one column, so that most cells stay whole.
Seams nearly_straight(std::mt19937& random, const Lattice& lattice, const std::array<int, 3>& shape,
                      Axis axis, Seams::Kind kind, int entry) {
    auto out = random_seams(random, lattice, shape, axis, kind, 2, {1});
    for (auto& seam : out.seams) {
        seam.at =
            std::vector<std::uint16_t>(out.columns_per_frame(), static_cast<std::uint16_t>(entry));
        seam.at.all()[random() % out.columns_per_frame()] += 1;
    }
    return out;
}

CoordBBox around(const Lattice& lattice, int margin) {
    const auto box = Mapping(lattice).world_box(
        {Vec3d(0), Vec3d(lattice.shape[0] - 1, lattice.shape[1] - 1, lattice.shape[2])});
    return {Coord::floor(box.min()).offsetBy(-margin), Coord::ceil(box.max()).offsetBy(margin)};
}

}  // namespace

TEST_CASE(
    "filter.seam gives voxels along any seam of a chain what the filter gives there, and all "
    "others their own bits") {
    std::mt19937 random(3);
    const auto lattice = make_box(Vec3d(0), {22, 17, 9}, 1.0, {1, 2, 0});
    const auto alignment = align(lattice, *openvdb::math::Transform::createLinearTransform(1.0));
    const auto grid = noise(random, around(lattice, 10));
    for (int n = 0; n < 12; ++n) {
        const auto mode = n % 3 == 0   ? FilterMode::mean
                          : n % 3 == 1 ? FilterMode::median
                                       : FilterMode::gaussian;
        const int width = 1 + n / 3 % 2;
        std::vector<Seams> sets;
        auto shape = lattice.shape;
        for (int step = 0; step < 1 + n % 3; ++step) {
            const auto kind = (n + step) % 2 ? Seams::Kind::remove : Seams::Kind::insert;
            const auto axis = step == 1 ? Axis::v : Axis::u;
            sets.push_back(n == 7
                               ? random_pairs(random, lattice, shape, axis, kind, 2, {1})
                               : nearly_straight(random, lattice, shape, axis, kind, 3 + 2 * step));
            shape = sets.back().shape_after(sets.back().seams.size());
        }
        std::vector<Displacements> displacements(sets.begin(), sets.end());
        const auto got = filtered<FloatGrid>(grid, lattice, map_of(lattice, sets), mode, width),
                   smooth = FloatGrid::ConstPtr(filtered_field(*grid, mode, width, 1));
        int seam = 0, kept = 0, changed = 0;
        for (auto voxel = grid->cbeginValueOn(); voxel; ++voxel) {
            const auto at = voxel.getCoord();
            const auto vertex = alignment->vertex(at);
            const bool inside =
                vertex.z() >= 0 && vertex.z() < shape[2] && vertex.x() >= 0 && vertex.y() >= 0;
            const float value = got->tree().getValue(at);
            if (inside && along_any(displacements, vertex.asVec3d())) {
                ++seam;
                REQUIRE(value == Approx(smooth->tree().getValue(at)).epsilon(1e-5));
                changed += value != *voxel;
            } else {
                ++kept;
                REQUIRE(value == *voxel);
            }
        }
        INFO("case " << n);
        CHECK(seam > 300);
        CHECK(kept > 10000);
        CHECK(changed > 0.9 * seam);
    }
}

TEST_CASE(
    "in bent lattices filter.seam finds the cells of seams by position, across the closing too, "
    "and components by their faces") {
    std::mt19937 random(4);
    for (const auto& lattice : {ring(Vec3d(0.2, 0.1, 0.3), {15, 9, 60}, 1.0, Vec2d(-7, -4)),
                                helix({13, 9, 70}, 1.0, 14, 6)}) {
        const std::vector<Seams> sets{
            wavy_seams(lattice, Axis::u, Seams::Kind::remove, 6, 3, 1), [&] {
                auto inner = lattice;
                inner.shape[0] -= 3;
                return wavy_seams(inner, Axis::v, Seams::Kind::insert, 3, 2, 1);
            }()};
        const auto map = map_of(lattice, sets);
        const Mapping mapping(lattice, map.reach());
        std::vector<Displacements> displacements(sets.begin(), sets.end());
        const auto grid = noise(random, around(lattice, 8));
        auto faces = VectorGrid::create();
        faces->setGridClass(openvdb::GRID_STAGGERED);
        for (auto voxel = grid->cbeginValueOn(); voxel; ++voxel)
            faces->tree().setValue(voxel.getCoord(),
                                   openvdb::Vec3s(*voxel, 1 + *voxel, 2 - *voxel));
        const auto got = filtered<FloatGrid>(grid, lattice, map, FilterMode::mean, 1);
        const auto got_faces = filtered<VectorGrid>(faces, lattice, map, FilterMode::mean, 1);
        const auto smooth = filtered_field(*grid, FilterMode::mean, 1, 1);
        int seam = 0, kept = 0, at_closing = 0;
        for (auto voxel = grid->cbeginValueOn(); voxel; ++voxel) {
            const auto at = voxel.getCoord();
            const float mean = smooth->tree().getValue(at);
            const auto expect = [&](const Vec3d& p, float value, float own, float mean) {
                const auto place = mapping.locate(p);
                const bool divided = place && along_any(displacements, *place);
                if (divided) REQUIRE(value == Approx(mean).epsilon(1e-5));
                else REQUIRE(value == own);
                if (divided && place->z() > lattice.shape[2] - 1) ++at_closing;
                return divided;
            };
            ++(expect(at.asVec3d(), got->tree().getValue(at), *voxel, mean) ? seam : kept);
            const auto vector = got_faces->tree().getValue(at), own = faces->tree().getValue(at);
            for (int c = 0; c < 3; ++c) {
                auto face = at.asVec3d();
                face[c] -= 0.5;
                expect(face, vector[c], own[c], c == 0 ? mean : c == 1 ? 1 + mean : 2 - mean);
            }
        }
        CHECK(seam > 1500);
        CHECK(kept > 10000);
        CHECK((at_closing > 50) == lattice.closed);
    }
}

TEST_CASE("filter.seam takes the seams of the frame") {
    std::mt19937 random(5);
    const auto lattice = make_box(Vec3d(0), {20, 9, 9}, 1.0, {0, 1, 2});
    auto seams = wavy_seams(lattice, Axis::u, Seams::Kind::remove, 4, 1, 0);
    seams.frames = {1, 2};
    seams.seams[0].at = [&] {
        std::vector<std::uint16_t> at(2 * seams.columns_per_frame(), 4);
        std::fill(at.begin() + static_cast<std::ptrdiff_t>(seams.columns_per_frame()), at.end(),
                  std::uint16_t{12});
        return at;
    }();
    const auto grid = noise(random, CoordBBox(Coord(-4), Coord(24)));
    for (const int frame : {1, 2}) {
        const auto got = filtered<FloatGrid>(grid, lattice, map_of(lattice, {seams}, frame),
                                             FilterMode::mean, 1);
        for (int x = 0; x < 20; ++x) {
            const int seam = frame == 1 ? 4 : 12;
            CHECK((got->tree().getValue({x, 4, 4}) != grid->tree().getValue({x, 4, 4})) ==
                  (x == seam - 1 || x == seam));
        }
    }
}

TEST_CASE(
    "filter.seam keeps states, inactive voxels, names and what can't be averaged, and active tiles "
    "open only where something differs") {
    std::mt19937 random(6);
    const auto lattice = make_box(Vec3d(0), {30, 16, 16}, 1.0, {0, 1, 2});
    const auto seams =
        std::make_shared<Seams>(wavy_seams(lattice, Axis::u, Seams::Kind::remove, 12, 3, 1));
    const auto grid = FloatGrid::create(0.5f);
    grid->setName("smoke");
    grid->tree().addTile(1, Coord(8, 0, 0), 2.0f, true);
    grid->tree().addTile(1, Coord(8, 8, 8), 2.0f, true);
    grid->tree().setValueOn({13, 3, 9}, 7.0f);
    auto voxels = openvdb::Int32Grid::create(1);
    voxels->tree().setValue({12, 4, 4}, 3);
    auto marked = MaskGrid::create();
    marked->tree().setValueOn({12, 4, 4});
    const auto volume = std::make_shared<Volume>();
    volume->grids = {grid, voxels, marked};

    const NodeBench::Inputs inputs{{"source", {Payload(volume)}},
                                   {"lattice", {Payload(std::make_shared<Lattice>(lattice))}},
                                   {"seams", {Payload(seams)}}};
    const auto out =
        NodeBench(filter_seam(), "{filter: mean, width: 1}").run(inputs).at("volume").as<Volume>();
    CHECK(out->grids[1] == volume->grids[1]);
    CHECK(out->grids[2] == volume->grids[2]);
    const auto& got = static_cast<const FloatGrid&>(*out->grids[0].grid());
    CHECK(got.getName() == "smoke");
    CHECK(got.activeVoxelCount() == grid->activeVoxelCount());
    CHECK(got.tree().getValue({12, 7, 12}) == 0.5f);
    CHECK(got.tree().getValue({12, 3, 3}) == 2.0f);
    CHECK(got.tree().getValue({13, 3, 9}) == Approx((26 * 0.5 + 7) / 27).epsilon(1e-2));

    CHECK(NodeBench(filter_seam(), "{count: 0}").run(inputs).at("volume").as<Volume>() == volume);
    const auto flat = volume_of(FloatGrid::create(3.0f));
    CHECK(seam_filtered(flat, lattice, map_of(lattice, {*seams}), FilterMode::mean, 1).grids[0] ==
          flat.grids[0]);
}

TEST_CASE("filter.seam names a value that is not finite if it lies within reach of a seam") {
    std::mt19937 random(7);
    const auto lattice = make_box(Vec3d(0), {20, 9, 9}, 1.0, {0, 1, 2});
    const auto map = map_of(lattice, {wavy_seams(lattice, Axis::u, Seams::Kind::remove, 8, 1, 0)});
    for (const auto mode : {FilterMode::mean, FilterMode::median, FilterMode::gaussian}) {
        const auto grid = noise(random, CoordBBox(Coord(-4), Coord(24)));
        grid->setName("smoke");
        grid->tree().setValue({15, 4, 4}, std::numeric_limits<float>::quiet_NaN());
        CHECK(failure_of([&] { filtered<FloatGrid>(grid, lattice, map, mode, 1); }).empty());
        grid->tree().setValue({9, 4, 4}, std::numeric_limits<float>::infinity());
        CHECK(failure_of([&] {
                  filtered<FloatGrid>(grid, lattice, map, mode, 1);
              }).find("'smoke' has a value that is not finite") != std::string::npos);
    }
}

TEST_CASE("filter.seam does not depend on the number of threads") {
    std::mt19937 random(8);
    const auto lattice = ring(Vec3d(0), {18, 10, 90}, 0.5, Vec2d(-4, -2));
    const auto grid = noise(random, CoordBBox(Coord(-30, -30, -6), Coord(30, 30, 12)), 0.5);
    const auto map = map_of(lattice, {wavy_seams(lattice, Axis::u, Seams::Kind::remove, 7, 5, 2)});
    FloatGrid::ConstPtr one, four;
    tbb::task_arena(1).execute(
        [&] { one = filtered<FloatGrid>(grid, lattice, map, FilterMode::gaussian, 2); });
    tbb::task_arena(4).execute(
        [&] { four = filtered<FloatGrid>(grid, lattice, map, FilterMode::gaussian, 2); });
    CHECK(one != FloatGrid::ConstPtr(grid));
    CHECK(bytes(one->tree()) == bytes(four->tree()));
}
