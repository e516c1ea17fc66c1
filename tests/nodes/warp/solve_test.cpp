#include "nodes/warp.h"

#include "carve/warp/find_warp.h"
#include "tests/support/scratch.h"
#include "tests/support/seams_through.h"
#include "tests/support/solver_bench.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <cstring>
#include <limits>
#include <vector>

using namespace fluidcarve;
using namespace fluidcarve::test;
using openvdb::Coord;
using openvdb::CoordBBox;

namespace {

constexpr std::array shape{24, 5, 6};
constexpr std::size_t frames = 3;
const CoordBBox everywhere(Coord(0), Coord(shape[0] - 1, shape[1] - 1, shape[2] - 1));

float noise(const Coord& at, std::size_t t) {
    const auto n = static_cast<unsigned>(at.x() * 73 + at.y() * 19 + at.z() * 7) +
                   static_cast<unsigned>(t) * 31;
    return static_cast<float>(n * 2654435761u % 1000) / 250 + 0.05f;
}

std::vector<FloatGrid::Ptr> energies() {
    std::vector<FloatGrid::Ptr> out;
    for (std::size_t t = 0; t < frames; ++t)
        out.push_back(energy_grid(everywhere, [t](const Coord& at) { return noise(at, t); }));
    return out;
}

Solved warp(const std::string& yaml, const Grids& grids = {}, const Otherwise& otherwise = {},
            const std::vector<Ref<Seams>>& after = {}) {
    return solve(warp_solve(), yaml, energies(), {box(shape)}, grids, frames, after, otherwise);
}

/// A run that goes on from a result.
Otherwise from(const Solved& before) {
    Otherwise out;
    out.before = before.seams;
    out.reported = before.listener.entry;
    return out;
}

/// A run with so many bytes of memory.
Otherwise within(std::uint64_t bytes) {
    Otherwise out;
    out.limits.memory = bytes;
    return out;
}

/// The displacement of a vertex.
double at(const Seams& set, int u, int lateral, int k, std::size_t t) {
    std::vector<float> column(static_cast<std::size_t>(set.before()));
    set.warp->column(t, lateral, k, column);
    return static_cast<double>(column[static_cast<std::size_t>(u)]);
}

/// Voxels from one corner to the other.
std::vector<Coord> voxels(const Coord& low, const Coord& high) {
    std::vector<Coord> out;
    for (auto voxel = CoordBBox(low, high).begin(); voxel; ++voxel) out.push_back(*voxel);
    return out;
}

bool same_values(const Warp& a, const Warp& b) {
    for (std::size_t t = 0; t < frames; ++t)
        if (std::memcmp(a.values(t).data(), b.values(t).data(), a.values(t).size_bytes()) != 0)
            return false;
    return a.frames() == b.frames();
}

std::string faults(const std::string& yaml) { return NodeBench(warp_solve(), yaml).faults(); }

const Growth& growth() {
    static const auto type = warp_solve();
    return *type.growth;
}

std::size_t wanted(const std::string& yaml) {
    return growth().wanted(NodeBench(warp_solve(), yaml, {{"after", 1}}).params(), shape[0]);
}

}  // namespace

TEST_CASE("warp.solve makes the lattice longer or shorter by any amount, also a share of it") {
    for (const auto& [text, vertices] :
         {std::pair("-1.5", -1.5), std::pair("-25%", -6.0), std::pair("7.25", 7.25)}) {
        const auto solved = warp(fmt::format("{{amount: {}}}", text));
        REQUIRE(solved.seams->warp);
        CHECK(solved.seams->seams.empty());
        CHECK(at(*solved.seams, 0, 2, 3, 1) == 0);
        CHECK(at(*solved.seams, shape[0] - 1, 2, 3, 1) == vertices);
        CHECK(solved.listener.entry["amount"] == vertices);
        CHECK(solved.listener.entry["shape"] == nlohmann::ordered_json({24, 5, 6, 3}));
        CHECK(solved.listener.entry["steepest"].get<double>() < most_squeezed + 1e-3);
    }
    CHECK_FALSE(warp("{amount: 0}").seams->warp);
}

TEST_CASE("a kept warp answers other amounts as a search of their own would, bit for bit") {
    const auto kept = warp("{amount: -1.5}");
    REQUIRE(kept.seams->warp->linear());
    const auto extent = growth().item_count(Payload(kept.seams));
    for (const std::string amount : {"-0.7", "7.2", "0.125"}) {
        const auto yaml = "{amount: " + amount + "}";
        REQUIRE(extent.count >= wanted(yaml));
        const auto own = warp(yaml);
        auto entry = kept.listener.entry;
        const auto cut = growth().first(Payload(kept.seams), wanted(yaml), entry).as<Seams>();
        CHECK(same_values(*cut->warp, *own.seams->warp));
        CHECK(cut->warp->scale() == own.seams->warp->scale());
        CHECK(entry["amount"] == own.listener.entry["amount"]);
        CHECK(entry["steepest"] == own.listener.entry["steepest"]);
    }
    // Not one that is too tight for it, nor a curve; nothing at all is answered by anything.
    CHECK(extent.count < wanted("{amount: -20}"));
    CHECK(growth().rest(NodeBench(warp_solve(), "{amount: -3}").params()) ==
          growth().rest(NodeBench(warp_solve(), "{amount: 30}").params()));
    // A percentage may count content, which is known later.
    CHECK(growth().rest(NodeBench(warp_solve(), "{amount: -3}").params()) !=
          growth().rest(NodeBench(warp_solve(), "{amount: -30%}").params()));
    CHECK(growth().rest(NodeBench(warp_solve(), "{amount: {along: w, at: [[0, -3]]}}").params()) !=
          growth().rest(NodeBench(warp_solve(), "{amount: -3}").params()));
    auto entry = kept.listener.entry;
    CHECK_FALSE(
        growth().first(Payload(kept.seams), wanted("{amount: 0}"), entry).as<Seams>()->warp);
}

TEST_CASE("a warp that is too tight to be linear is kept for its own amount alone") {
    const Grids soft{{"attract", {mask_grid(voxels(Coord(4, 0, 0), Coord(8, 4, 5)))}}};
    const auto kept = warp("{amount: -7}", soft);
    REQUIRE_FALSE(kept.seams->warp->linear());
    CHECK(growth().item_count(Payload(kept.seams)).count < wanted("{amount: -7}"));
    CHECK(growth().item_count(Payload(kept.seams)).count < wanted("{amount: -0.01}"));
    const auto again = warp("{amount: -7}", soft, from(kept));
    CHECK(same_values(*again.seams->warp, *kept.seams->warp));
    CHECK(again.listener.entry == kept.listener.entry);
    const auto less = warp("{amount: -6.5}", soft, from(kept)), own = warp("{amount: -6.5}", soft);
    CHECK(same_values(*less.seams->warp, *own.seams->warp));
}

TEST_CASE("an amount may follow a curve along the lattice, over time, or both") {
    const auto along = warp("{amount: {along: w, at: [[0, 0], [0.4, 0], [1, -6]]}}");
    const auto time = warp("{amount: {along: time, at: [[5, 0], [7, 4]]}}");
    const auto both =
        warp("{amount: {along: w, at: [[0, 0], [1, -10%]], over: [[5, 0.5], [7, 1]]}}");
    const int last = shape[0] - 1;
    for (std::size_t t = 0; t < frames; ++t)
        for (int k = 0; k < shape[2]; ++k) {
            const double w = k / 5.0;
            CHECK(at(*along.seams, last, 2, k, t) ==
                  Approx(w <= 0.4 ? 0 : -6 * (w - 0.4) / 0.6).margin(1e-5));
            CHECK(at(*time.seams, last, 2, k, t) ==
                  Approx(2.0 * static_cast<double>(t)).margin(1e-5));
            CHECK(at(*both.seams, last, 2, k, t) ==
                  Approx(-2.4 * w * (0.5 + 0.25 * static_cast<double>(t))).margin(1e-5));
            for (int u = 0; u <= last; ++u)
                if (w <= 0.4) CHECK(at(*along.seams, u, 2, k, t) == 0);
        }
}

TEST_CASE("a curve that is 0 in all frames of the run moves nothing") {
    CHECK_FALSE(warp("{amount: {along: time, at: [[100, 0], [101, -5]]}}").seams->warp);
}

TEST_CASE("amounts from a file warp as the same curve in the pipeline does") {
    const Scratch scratch;
    const auto of_file = [&](const std::string& name, const std::string& text) {
        return warp("{amount_file: " + scratch.write(name, text) + "}");
    };
    const auto stated = warp("{amount: {along: w, at: [[0, 0], [0.4, 0], [1, -25%]]}}");
    const auto read = of_file(
        "ramp.csv",
        "# a ramp\nw; note; amount\n0; ground; 0\n\n0.4; flame; 0\r\n1; top; -25%  # a quarter\n");
    CHECK(same_values(*read.seams->warp, *stated.seams->warp));
    CHECK(read.listener.entry["amounts"] == nlohmann::ordered_json({-6, 0}));
    CHECK(same_values(*of_file("growth.csv", "time,amount\n5,0\n7,4\n").seams->warp,
                      *warp("{amount: {along: time, at: [[5, 0], [7, 4]]}}").seams->warp));
    CHECK_FALSE(of_file("still.csv", "w,amount\n0,0\n1,0\n").seams->warp);
    // Not kept as the answer to another amount.
    CHECK(growth().item_count(Payload(read.seams)).count == wanted("{amount_file: ramp.csv}"));
    CHECK(growth().rest(NodeBench(warp_solve(), "{amount_file: ramp.csv}").params()) !=
          growth().rest(NodeBench(warp_solve(), "{amount: -3}").params()));
}

TEST_CASE("a file may state another curve along the lattice for each frame") {
    const Scratch scratch;
    const auto solved =
        warp("{amount_file: " +
             scratch.write("both.csv", "time, w, amount\n5, 0, -1\n5, 1, -3\n7, 0.5, 2\n") + "}");
    for (int k = 0; k < shape[2]; ++k) {
        const double first = -1 - 2 * (k / 5.0);
        CHECK(at(*solved.seams, shape[0] - 1, 2, k, 0) == Approx(first).margin(1e-5));
        CHECK(at(*solved.seams, shape[0] - 1, 2, k, 1) == Approx((first + 2) / 2).margin(1e-5));
        CHECK(at(*solved.seams, shape[0] - 1, 2, k, 2) == Approx(2).margin(1e-5));
    }
}

TEST_CASE("a file that holds no amounts is refused with its line, its fault and what it needs") {
    using Catch::Contains;
    const Scratch scratch;
    const auto fault = [&](const std::string& text, const std::string& more = "",
                           const std::string& name = "a.csv") -> std::string {
        try {
            warp("{amount_file: " + scratch.write(name, text) + more + "}");
        } catch (const Failure& failure) {
            return failure.what();
        }
        return "";
    };
    CHECK_THAT(fault(""),
               Contains("a.csv: there is nothing in it: the first line names the columns"));
    CHECK_THAT(fault("w,amount\n"), Contains("a.csv: there are no points in it"));
    CHECK_THAT(fault("0,0\n1,-3\n"), Contains("a.csv:1: there is no column 'amount'"));
    CHECK_THAT(fault("x,amount\n0,0\n"), Contains("a.csv:1: there is no column 'w' or 'time'"));
    CHECK_THAT(
        fault("w,amount\n0,0\n1\n"),
        Contains("a.csv:3: a line needs 2 columns, as the first one has, but this one has 1"));
    CHECK_THAT(fault("w,amount\n0,nan\n"), Contains("a.csv:2: 'nan' is no number"));
    CHECK_THAT(fault("w,amount\n0,0\n0,-3\n"),
               Contains("a.csv:3: this point, at 0, stands behind one at 0: points must rise"));
    CHECK_THAT(fault("w,amount\n0,0\n1.5,-3\n"), Contains("a.csv:3: 1.5 is no place along w"));
    CHECK_THAT(fault("time,w,amount\n6,0,0\n5,0,-3\n"),
               Contains("a.csv:3: frame 5 stands behind 6: frames must rise"));
    CHECK_THAT(fault("w,amount\n0,-22\n"),
               Contains("at plane 0 in frame 5") && Contains("at most 20.7 are possible"));
    CHECK_THAT(fault("time,amount\n5,0\n7,-3\n", ", static: true"),
               Contains("a.csv: its amounts change over time, but a static warp is the same"));
    CHECK_THAT(fault("w,amount\n0,0\n", "", "a.txt"),
               Contains("a.txt: amounts are read from .csv, not from '.txt'"));
    CHECK_THAT(faults("{}"), Contains("needs an 'amount'") && Contains("'amount_file'"));
    CHECK_THAT(faults("{amount: -3, amount_file: a.csv}"), Contains("leave one of the two out"));
    CHECK_THAT(faults("{amount_file: a.####.csv}"), Contains("can't have a frame token"));
}

TEST_CASE("the anchor of a warp stays in place in each column") {
    const auto middle = warp("{amount: {along: w, at: [[0, 0], [1, -6]]}, anchor: middle}");
    CHECK(at(*middle.seams, 0, 1, 5, 0) == 3);
    CHECK(at(*middle.seams, 23, 1, 5, 0) == -3);
    CHECK(at(*middle.seams, 12, 1, 0, 0) == 0);
    const auto vertex = warp("{amount: 4, anchor: 9}");
    CHECK(at(*vertex.seams, 9, 1, 5, 2) == 0);
}

TEST_CASE("a warp between two windows moves both ends of its own window, and is kept for all") {
    const std::string windows = "window: [9, 14], pair_window: [[1, 8], [15, 22]]";
    const auto solved = warp("{amount: -1, " + windows + "}");
    CHECK(at(*solved.seams, 1, 2, 3, 1) == 0);
    CHECK(at(*solved.seams, 8, 2, 3, 1) == 0.5);
    CHECK(at(*solved.seams, 9, 2, 3, 1) == 0.5);
    CHECK(at(*solved.seams, 14, 2, 3, 1) == -0.5);
    CHECK(at(*solved.seams, 22, 2, 3, 1) == 0);
    CHECK(solved.seams->shape_after(1) == shape);
    REQUIRE(solved.seams->warp->linear());
    REQUIRE(solved.seams->pair_below);
    CHECK(solved.seams->pair_below->last == 8);
    // As text it is read back.
    const NodeBench bench(warp_solve(), "{amount: -1, " + windows + "}");
    CHECK(warp_solve().param("pair_window")->text(bench.params()) == "[[1, 8], [15, 22]]");
    // What is kept answers other amounts of its sign.
    const auto less = "{amount: -0.25, " + windows + "}";
    auto entry = solved.listener.entry;
    const auto cut = growth().first(Payload(solved.seams), wanted(less), entry).as<Seams>();
    const auto own = warp(less);
    CHECK(same_values(*cut->warp, *own.seams->warp));
    CHECK(cut->warp->scale() == own.seams->warp->scale());
}

TEST_CASE("a static warp is the same in all frames") {
    const auto solved = warp("{amount: -3, static: true}");
    CHECK(solved.seams->warp->frames() == 1);
    CHECK(at(*solved.seams, 11, 2, 2, 0) == at(*solved.seams, 11, 2, 2, 2));
}

TEST_CASE("what is protected moves as a whole, and what is attracted gives first") {
    const Grids grids{{"protect", {mask_grid(voxels(Coord(10, 0, 0), Coord(15, 4, 5)))}},
                      {"attract", {mask_grid(voxels(Coord(2, 0, 0), Coord(5, 4, 5)))}}};
    const auto solved = warp("{amount: -3}", grids);
    CHECK(at(*solved.seams, 15, 2, 2, 1) == Approx(at(*solved.seams, 10, 2, 2, 1)).margin(5e-3));
    CHECK(at(*solved.seams, 5, 2, 2, 1) - at(*solved.seams, 2, 2, 2, 1) < -2);
    CHECK(solved.listener.entry["protected"] == 3 * 6 * 5 * 6);
    CHECK(solved.listener.entry["attracted"] == 3 * 4 * 5 * 6);
}

TEST_CASE("a coarser warp does the same but for its detail") {
    const auto fine = warp("{amount: -4}"), coarse = warp("{amount: -4, factor: 2}");
    CHECK(coarse.listener.entry["factor"] == 2);
    CHECK(at(*coarse.seams, 23, 2, 3, 1) == -4);
    for (int u = 0; u < shape[0]; ++u)
        CHECK(at(*coarse.seams, u, 2, 3, 1) == Approx(at(*fine.seams, u, 2, 3, 1)).margin(1));
    CHECK(fine.listener.entry["factor"] == 1);
}

TEST_CASE("a warp is the same whatever the memory") {
    const auto ample = warp("{amount: -4}"), scarce = warp("{amount: -4}", {}, within(12000));
    CHECK(scarce.listener.entry["factor"] == 1);
    for (int t = 0; t < 3; ++t)
        for (int u = 0; u < shape[0]; ++u)
            CHECK(at(*scarce.seams, u, 2, 3, t) == at(*ample.seams, u, 2, 3, t));
}

TEST_CASE("a warp is found in the space that seams before it leave") {
    const auto before = warp("{amount: -4.5}");
    const auto solved = warp("{amount: -2}", {}, {}, {before.seams});
    CHECK(solved.seams->before() == before.seams->shape_after(1)[0]);
    CHECK(at(*solved.seams, solved.seams->before() - 1, 2, 2, 0) == -2);
}

TEST_CASE("a warp may make the rest of an amount, towards which the seams before it count") {
    auto seams = std::make_shared<Seams>(
        straight_seams(box(shape), Axis::u, Seams::Kind::remove, {8, 9, 10}, {5, 6, 7}));
    for (const auto& [amount, left] :
         {std::pair("-4.5", -1.5), {"-25%", -3.0}, {"2", 5.0}, {"0", 3.0}}) {
        const auto solved =
            warp(fmt::format("{{amount: {}, rest: true}}", amount), {}, {}, {seams});
        REQUIRE(solved.seams->warp);
        CHECK(solved.seams->before() == 21);
        CHECK(at(*solved.seams, 20, 2, 2, 0) == left);
        CHECK(solved.listener.entry["amount"] == left);
        // It answers no other amount, since that of others is of another space.
        CHECK(growth().item_count(Payload(solved.seams)).count ==
              wanted("{amount: -4.5, rest: true}"));
    }
    CHECK_FALSE(warp("{amount: -3, rest: true}", {}, {}, {seams}).seams->warp);
    CHECK(growth().rest(
              NodeBench(warp_solve(), "{amount: -3, rest: true}", {{"after", 1}}).params()) !=
          growth().rest(
              NodeBench(warp_solve(), "{amount: -4, rest: true}", {{"after", 1}}).params()));
    CHECK_THAT(faults("{amount: -3, rest: true}"), Catch::Contains("'rest' needs `after`"));
    CHECK_THAT(faults("{amount: {along: w, at: [[0, 0]]}, rest: true}"),
               Catch::Contains("'rest' is of a single 'amount', not of a curve"));
    CHECK_THAT(faults("{amount: -3, rest: true, window: [1, 5], pair_window: [6, 9]}"),
               Catch::Contains("there is no rest"));
}

TEST_CASE("what warp.solve can't do is told with its place, its fault and a remedy") {
    using Catch::Contains;
    const auto fails = [](const std::string& yaml, const Grids& grids = {}) -> std::string {
        try {
            warp(yaml, grids);
        } catch (const Failure& failure) {
            return failure.what();
        }
        return "";
    };
    CHECK_THAT(fails("{amount: -23}"),
               Contains("window [0, 23] by 23 vertices, but at most 20.7 are possible") &&
                   Contains("ask for less"));
    CHECK_THAT(fails("{amount: {along: w, at: [[0, 0], [1, -22]]}}"),
               Contains("at plane 5 in frame 5"));
    CHECK_THAT(
        fails("{amount: -3, window: [20, 30]}"),
        Contains("window [20, 30] leaves the lattice, which has 24 vertices along u: 0 to 23"));
    CHECK_THAT(fails("{amount: 10, window: [9, 14], pair_window: [[0, 4], [16, 20]]}"),
               Contains("squeezes pair_window [16, 20] by 5 vertices, but at most 3.6"));
    CHECK_THAT(fails("{amount: 3, window: [20%, 80%], pair_window: [[0%, 30%], [80%, 100%]]}"),
               Contains("[0%, 30%], the first of two, overlaps window [20%, 80%]; it must end at "
                        "vertex 5 or below"));
    CHECK_THAT(fails("{amount: -3, anchor: 24}"), Contains("anchor 24 lies beyond the lattice"));
    auto undefined = energies();
    undefined[1]->tree().setValue(Coord(3, 2, 1), std::numeric_limits<float>::quiet_NaN());
    CHECK_THROWS_WITH(
        solve(warp_solve(), "{amount: -3}", undefined, {box(shape)}, {}, frames),
        Contains("the energy is nan at (3, 2, 1), vertex (3, 2, 1)") && Contains("from 0 to"));
    CHECK_THAT(fails("{amount: 70000}"), Contains("more than 65534 vertices"));
    CHECK_THAT(fails("{amount: -3}", {{"protect", {mask_grid(voxels(Coord(0), Coord(23, 4, 5)))}}}),
               Contains("no amount is possible: in frame 5 column (0 to 23, 0, 0)") &&
                   Contains("has 0 of 23 intervals that are not protected") &&
                   Contains("protect less"));
}

TEST_CASE("a percentage counts the content where there is one, else the lattice") {
    // Ten vertices wide, in four of five rows and in five of six planes.
    const auto content =
        energy_grid(CoordBBox(Coord(6, 0, 0), Coord(15, 3, 4)), [](const Coord&) { return 1.0f; });
    const auto narrower = warp("{amount: -30%}", {{"content", {content}}});
    CHECK(narrower.listener.entry["amount"] == -3);
    CHECK(warp("{amount: -25%}").listener.entry["amount"] == -6);
    CHECK(warp("{amount: {along: time, at: [[5, 0], [7, -50%]]}}", {{"content", {content}}})
              .listener.entry["amount"] == "{along: time, at: [[5, 0], [7, -5]]}");
    // Where nothing is shown, there is no width.
    CHECK(warp("{amount: -25%}", {{"content", {FloatGrid::create(0)}}}).listener.entry["amount"] ==
          -6);
    CHECK_THROWS_WITH(warp("{amount: -900%}", {{"content", {content}}}),
                      Catch::Contains("squeezes"));
}

TEST_CASE("a bad amount is refused before the run") {
    using Catch::Contains;
    CHECK_THAT(faults("{amount: wide}"), Contains("must be a number, not 'wide'"));
    CHECK_THAT(faults("{amount: .nan}"), Contains("must be a number"));
    for (const std::string weight :
         {"field_weight", "evenness", "empty", "stiffness", "stiffness_time"})
        CHECK_THAT(faults("{amount: -3, " + weight + ": .nan}"),
                   Contains(weight + " must be a number"));
    CHECK_THAT(faults("{amount: [1, 2]}"),
               Contains("must be a number of vertices, a percentage such as -10%, or {along"));
    CHECK_THAT(faults("{amount: {along: w, at: []}}"), Contains("has no points in 'at'"));
    CHECK_THAT(faults("{amount: {along: w}}"), Contains("lacks 'at'"));
    CHECK_THAT(faults("{amount: {at: [[0, 1]]}}"), Contains("lacks 'along'"));
    CHECK_THAT(faults("{amount: {along: x, at: [[0, 1]]}}"), Contains("one of w, time"));
    CHECK_THAT(faults("{amount: {along: w, at: [[0, 1], [0, 2]]}}"), Contains("points must rise"));
    CHECK_THAT(faults("{amount: {along: w, at: [[0, 1], [7, 2]]}}"),
               Contains("has a point at 7 of the way along w"));
    CHECK_THAT(faults("{amount: {along: w, at: [[0, 1], 3]}}"),
               Contains("a list of points in 'at'"));
    CHECK_THAT(faults("{amount: {along: w, at: [[0, nan]]}}"),
               Contains("must be a number, not 'nan'"));
    CHECK_THAT(faults("{amount: {along: w, at: [[0, 1]], when: 3}}"), Contains("no field 'when'"));
    CHECK_THAT(faults("{amount: {along: time, at: [[1, 0], [9, -3]]}, static: true}"),
               Contains("changes over time"));
    CHECK_THAT(faults("{amount: -3, factor: 3}"), Contains("must be auto, 1, 2 or 4, not 3"));
    CHECK_THAT(faults("{amount: -3, window: [3, 9], pair_window: [5, 12]}"),
               Contains("overlaps window [3, 9]"));
    CHECK_THAT(faults("{amount: -3, window: [9, 14], pair_window: [[15, 18], [20, 23]]}"),
               Contains("[15, 18], the first of two, lies above window [9, 14]"));
    CHECK_THAT(faults("{amount: -3, window: [9, 14], pair_window: [[1, 2], [3, 4], [20, 23]]}"),
               Contains("must be [first, last]"));
    CHECK_THAT(faults("{amount: -3, pair_window: [5, 12]}"),
               Contains("needs a 'window' beside it"));
    CHECK_THAT(faults("{amount: -3, window: [2.5, 9]}"), Contains("whole vertices"));
    CHECK(faults("{amount: {along: time, at: [[1001, -10%]], over: [[0, 0], [0.5, 1]]}}") == "");
    // As text it is read back.
    const NodeBench bench(
        warp_solve(), "{amount: {along: time, at: [[1, 0], [9, -10%]], over: [[0, 0], [1, 1]]}}");
    const auto text = warp_solve().param("amount")->text(bench.params());
    CHECK(text == "{along: time, at: [[1, 0], [9, -10%]], over: [[0, 0], [1, 1]]}");
    CHECK(warp_solve().param("amount")->text(
              NodeBench(warp_solve(), "{amount: " + text + "}").params()) == text);
}
