#include "nodes/result/carve_result.h"
#include "nodes/remap.h"
#include "nodes/result/grid_measure.h"
#include "tests/support/node_bench.h"
#include "tests/support/reference_carve.h"

#include <tbb/global_control.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <limits>
#include <random>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::BBoxd;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;
using Json = nlohmann::ordered_json;

namespace {

/// What a node told.
struct Heard : Context::Host {
    std::map<std::string, Json> sections;  ///< of the report
    std::vector<std::string> lines, warnings;
    void warn(const std::string& message) override { warnings.push_back(message); }
    void tell(const std::string& line) override { lines.push_back(line); }
    void report(const std::string& section, const Json& entry) override {
        auto& known = sections.try_emplace(section, Json::object()).first->second;
        known.update(entry);
    }
    const Json& section(const std::string& name) { return sections[name]; }
};

/// A grid of voxels of edge 1 that has one value in a box of 4 x 4 voxels across, from one voxel to
/// another along x.
FloatGrid::Ptr block(int first, int last, float value, const std::string& name = "density") {
    const auto out = FloatGrid::create();
    out->setName(name);
    out->sparseFill(CoordBBox(Coord(first, 0, 0), Coord(last, 3, 3)), value);
    return out;
}

using Frames = std::vector<std::vector<FloatGrid::Ptr>>;  ///< `[frame][grid]`

/// Removes straight seams along x from frames 1, 2, ... and lets the node conclude.
Heard removed(const Frames& frames, const std::vector<int>& entries,
              const std::string& params = "{}") {
    std::vector<int> numbers;
    for (std::size_t n = 0; n < frames.size(); ++n) numbers.push_back(static_cast<int>(n) + 1);
    const auto lattice = std::make_shared<Lattice>(make_box(Vec3d(0), {40, 4, 4}, 1.0, {0, 1, 2}));
    const auto seams = std::make_shared<Seams>(
        straight_seams(*lattice, Axis::u, Seams::Kind::remove, entries, numbers));
    NodeBench bench(remap_grids(), params);
    Heard out;
    for (std::size_t place = 0; place < frames.size(); ++place) {
        const auto volume = std::make_shared<Volume>();
        for (const auto& grid : frames[place]) volume->grids.push_back(grid);
        bench.run({{"source", {Payload(volume)}},
                   {"lattice", {Payload(lattice)}},
                   {"seams", {Payload(seams)}}},
                  Context(out, numbers).at(place));
    }
    Context context(out, numbers);
    if (!out.section("grids_by_frame").empty())
        bench.type().conclude(bench.params(), out.section("grids_by_frame"), context);
    return out;
}

using Lines = std::vector<std::string>;

}  // namespace

TEST_CASE("a grid's measure is of its active voxels, without values that are not finite") {
    const auto grid = FloatGrid::create();
    grid->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
    auto& tree = grid->tree();
    tree.setValue(Coord(0, 0, 0), 1.0f);
    tree.setValue(Coord(1, 0, 0), std::numeric_limits<float>::quiet_NaN());
    tree.setValue(Coord(2, 0, 0), -3.0f);
    tree.setValueOff(Coord(5, 5, 5), 7.0f);
    const auto found = measured(*grid);
    REQUIRE(found);
    CHECK(found->mass == 0.5);
    CHECK(found->highest == 3.0);
    CHECK(found->centre == Vec3d(0.75, 0, 0));
    CHECK(found->box == BBoxd(Vec3d(-0.25), Vec3d(1.25, 0.25, 0.25)));
    CHECK(voxel_edge(*grid) == Approx(0.5));

    const auto empty = measured(*FloatGrid::create());
    REQUIRE(empty);
    CHECK(empty->box.empty());
    CHECK(empty->mass == 0);
    CHECK_FALSE(measured(*MaskGrid::create()));
    CHECK_FALSE(measured(*VectorGrid::create()));
}

TEST_CASE("tiles count as the voxels that they stand for") {
    const auto grid = openvdb::DoubleGrid::create();
    grid->tree().addTile(1, Coord(8, 0, 0), 2.0, true);
    grid->tree().addTile(1, Coord(16, 0, 0), 9.0, false);
    const auto found = measured(*grid);
    REQUIRE(found);
    CHECK(found->mass == 1024);
    CHECK(found->highest == 2.0);
    CHECK(found->centre == Vec3d(11.5, 3.5, 3.5));
    CHECK(found->box == BBoxd(Vec3d(7.5, -0.5, -0.5), Vec3d(15.5, 7.5, 7.5)));
}

TEST_CASE("the mass of a level set is the volume that it encloses, inactive voxels too") {
    const auto grid = FloatGrid::create(3.0f);
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    grid->tree().setValue(Coord(0, 0, 0), 0.0f);
    grid->tree().setValue(Coord(1, 0, 0), -0.25f);
    grid->tree().setValueOff(Coord(2, 0, 0), -3.0f);
    grid->tree().addTile(1, Coord(8, 0, 0), -3.0f, false);
    const auto found = measured(*grid);
    REQUIRE(found);
    CHECK(found->mass == 0.5 + 0.75 + 1 + 512);
    CHECK_FALSE(found->highest);
    CHECK(found->box == BBoxd(Vec3d(-0.5), Vec3d(1.5, 0.5, 0.5)));
}

TEST_CASE("a measure is the same to the last bit whatever the threads") {
    std::mt19937 random(3);
    const auto grid = FloatGrid::create();
    auto values = grid->getAccessor();
    for (auto at = CoordBBox::createCube(Coord(-11), 60).begin(); at; ++at)
        values.setValue(*at, static_cast<float>(random() % 100000) / 7.0f);
    const auto with = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return *measured(*grid);
    };
    const auto one = with(1);
    for (const std::size_t threads : {2, 3, 4}) {
        const auto many = with(threads);
        CHECK(many.mass == one.mass);
        CHECK(many.centre == one.centre);
        CHECK(many.highest == one.highest);
    }
}

TEST_CASE("a carve says what it did to each grid, in a line and in the report") {
    auto out = removed({{block(0, 9, 1)}, {block(0, 9, 2)}, {block(0, 9, 1)}}, {3, 2});
    CHECK(out.lines ==
          Lines{"density 10 x 4 x 4 -> 8 x 4 x 4, mass -20.0 %, highest 1.00 of before"});
    CHECK(out.warnings.empty());
    const auto& frame = out.section("grids_by_frame")["2"]["density"];
    CHECK(frame["voxel"].get<double>() == Approx(1));
    CHECK(
        frame["before"] ==
        Json::parse(
            R"({"box": [[-0.5, -0.5, -0.5], [9.5, 3.5, 3.5]], "mass": 320.0, "highest": 2.0, "centre": [4.5, 1.5, 1.5]})"));
    CHECK(
        frame["after"] ==
        Json::parse(
            R"({"box": [[-0.5, -0.5, -0.5], [7.5, 3.5, 3.5]], "mass": 256.0, "highest": 2.0, "centre": [3.5, 1.5, 1.5]})"));
    const auto& all = out.section("grids")["density"];
    CHECK(all["frames"] == 3);
    for (const auto& [side, mass, end] :
         {std::tuple("before", 640.0 / 3, 9.5), std::tuple("after", 512.0 / 3, 7.5)}) {
        CHECK(all[side]["box"] == Json{{-0.5, -0.5, -0.5}, {end, 3.5, 3.5}});
        CHECK(all[side]["mass"].get<double>() == Approx(mass));
        CHECK(all[side]["highest"] == 2.0);
        CHECK(all[side]["centre"][0].get<double>() == Approx((end - 0.5) / 2));
        CHECK(all[side]["flicker"].get<double>() == Approx(0.75));
    }
}

TEST_CASE("a carve that changes nothing in a grid is warned of") {
    const auto out = removed({{block(0, 2, 1), block(0, 11, 1, "shadow"),
                               block(1, 2, 0.5f, "flame"), FloatGrid::create()}},
                             {8, 7});
    CHECK(out.lines ==
          Lines{"density 3 x 4 x 4, nothing changed",
                "shadow 12 x 4 x 4 -> 10 x 4 x 4, mass -16.7 %, highest 1.00 of before",
                "flame 2 x 4 x 4, nothing changed"});
    CHECK(out.warnings ==
          Lines{"the carve changed nothing in density, flame; if the lattice lies beside it, move "
                "or widen the lattice (`fit` of lattice.box; `rig`, `extent_u` "
                "and `extent_v` of lattice.build); if only the space beside it is carved, connect "
                "it as `field` of the solver, or raise the solver's `empty`"});
}

TEST_CASE("a carve that leaves nothing, in some frames or in all, is warned of") {
    auto out = removed({{block(3, 4, 1)}}, {3, 3});
    CHECK(out.lines == Lines{"density 2 x 4 x 4 -> nothing"});
    CHECK(out.warnings ==
          Lines{"nothing is left of density; carve less (`count` of seams, `amount` of a warp), or "
                "keep the carve off it (`protect` of the solver)"});
    CHECK(out.section("grids")["density"]["after"] == Json{{"mass", 0.0}, {"highest", 0.0}});

    out = removed({{block(3, 4, 1)}, {block(3, 6, 1)}}, {3, 3});
    CHECK(out.warnings ==
          Lines{
              "nothing is left of density in frame 1; carve less (`count` of seams, `amount` of a "
              "warp), or keep the carve off it (`protect` of the solver)",
          });
}

/// Thin at both ends, with a dense middle along x from 10 to 13.
FloatGrid::Ptr dense_middle(int last, const std::string& name = "density") {
    const auto out = block(0, last, 0.1f, name);
    out->sparseFill(CoordBBox(Coord(10, 0, 0), Coord(13, 3, 3)), 2.0f);
    return out;
}

TEST_CASE(
    "a carve that takes far more of the mass than even scaling does is warned of, one that narrows "
    "all alike is not") {
    // All of the seams go through the dense middle.
    CHECK(removed({{dense_middle(23)}}, {10, 10}).warnings ==
          Lines{"the carve changed the mass by far more or less than even scaling to the same "
                "size: density -40.0 %, even scaling -8.3 %; carve less (`count` of "
                "seams, `amount` of a warp), keep the carve off the content (`protect` of the "
                "solver), or keep the mass of densities (`conserve`)"});
    CHECK(removed({{block(0, 9, 1), block(0, 7, 1, "fuel")}}, {1, 1, 1, 1}).warnings.empty());
    // A grid of one value is no content, beside one that shows something: its ends stay beyond the
    // lattice, so that its box does not shrink.
    const auto shell = block(-4, 43, -1, "shadow");
    const std::vector<int> thirty(30, 5);
    CHECK_THAT(removed({{shell}}, thirty).warnings.back(),
               Catch::Contains("even scaling") && Catch::Contains("shadow -"));
    CHECK_THAT(removed({{dense_middle(40), shell}}, thirty).warnings.back(),
               !Catch::Contains("shadow -"));
    // The box around a surface says nothing of its width.
    const auto bulge = FloatGrid::create(1.5f);
    bulge->setName("surface");
    bulge->setGridClass(openvdb::GRID_LEVEL_SET);
    bulge->sparseFill(CoordBBox(Coord(0, 0, 0), Coord(24, 3, 3)), 0.5f);
    bulge->sparseFill(CoordBBox(Coord(1, 1, 1), Coord(23, 1, 1)), -0.5f);
    bulge->sparseFill(CoordBBox(Coord(10, 0, 0), Coord(13, 3, 3)), -0.5f);
    const auto out = removed({{bulge}}, {10, 10});
    CHECK(out.warnings.empty());
    CHECK(out.lines.size() == 1);
}

TEST_CASE(
    "an end that stands still while the other moves is the source: it is warned of if it moves by "
    "five voxels") {
    const auto moved = [](int seams, const Frames& frames) {
        auto out = removed(frames, std::vector<int>(static_cast<std::size_t>(seams), 0));
        return out.warnings;
    };
    const Frames growing{
        {block(20, 25, 0)}, {block(20, 25, 1)}, {block(20, 29, 1)}, {block(20, 35, 1)}};
    CHECK(moved(5, growing) ==
          Lines{"the end of density that stands still over the sequence, where its source is, "
                "moved by 5.0 voxels in frame 2; if it must stay "
                "in place, set `anchor` of the solver"});
    CHECK(moved(4, growing).empty());
    // Both ends stand, or both move: nothing tells where the source is.
    CHECK(moved(8, {{block(20, 29, 1)}, {block(20, 29, 1)}}).empty());
    CHECK(moved(8, {{block(20, 29, 1)}, {block(15, 33, 1)}}).empty());
    const auto picture = [](int last) {
        const auto out = FloatGrid::create();
        out->setName("R");
        out->sparseFill(CoordBBox(Coord(20, 0, 0), Coord(last, 3, 0)), 1.0f);
        return out;
    };
    CHECK(moved(8, {{picture(25)}, {picture(29)}}).empty());
}

TEST_CASE(
    "a grid that is a level set in some frames only counts as two, so that figures stay true") {
    const auto level = FloatGrid::create(3);
    level->setName("density");
    level->setGridClass(openvdb::GRID_LEVEL_SET);
    level->sparseFill(CoordBBox(Coord(0, 0, 0), Coord(9, 3, 3)), -1.0f);
    const auto out = removed({{block(0, 9, 1)}, {level}}, {4, 4}, "{renormalize: false}");
    CHECK(
        out.lines ==
        Lines{
            "density (no level set) 10 x 4 x 4 -> 8 x 4 x 4, mass -20.0 %, highest 1.00 of before",
            "density (level set) 10 x 4 x 4 -> 8 x 4 x 4, mass -20.0 %"});
}

TEST_CASE("grids of one name are told apart in the result") {
    const auto out = removed({{block(0, 9, 1), block(20, 29, 1)}}, {4, 4});
    CHECK(out.lines ==
          Lines{"density[0] 10 x 4 x 4 -> 8 x 4 x 4, mass -20.0 %, highest 1.00 of before",
                "density[1] 10 x 4 x 4 -> 10 x 4 x 4, mass +0.0 %, highest 1.00 of before"});
}

TEST_CASE("without seams nothing is told, and of velocities nothing is measured") {
    auto out = removed({{block(0, 9, 1)}}, {3, 2}, "{count: 0}");
    CHECK(out.lines.empty());
    CHECK(out.section("grids_by_frame").empty());
    out = removed({{block(0, 9, 1, "vel.x"), block(0, 9, 1, "vel.y"), block(0, 9, 1, "vel.z"),
                    block(0, 9, 1, "heat")}},
                  {3, 2});
    CHECK(out.lines == Lines{"heat 10 x 4 x 4 -> 8 x 4 x 4, mass -20.0 %, highest 1.00 of before"});
    CHECK(out.section("grids").size() == 1);
}
