#include "nodes/solving/report.h"
#include "carve/solver/costs/marks.h"
#include "nodes/solving/reported_seams.h"

#include <catch2/catch.hpp>

#include <memory>
#include <optional>

using namespace fluidcarve;

namespace {

constexpr std::size_t no_vertex = 0, few_vertices = 5;

Seams set_of(const std::vector<Seams::Seam>& seams) {
    Seams out;
    out.kind = Seams::Kind::insert;
    out.shape = {4, 1, 2};
    out.frames = {1};
    out.seams = seams;
    return out;
}

FoundSeams two_seams() {
    FoundSeams out;
    out.seams = {{{0, 1}, 3.0, 2.0}, {{2, 2}, 5.0}};
    out.wall_s = {0.0, 0.5};
    out.zero_share = {0.0, 1.0};
    out.attracted = {1, 0};
    out.blocked = {0, 0};
    out.attracted_left = {4, 4};
    return out;
}

}  // namespace

TEST_CASE("a report describes each seam, its marks only if there is such a mask") {
    const auto found = two_seams();
    auto report = empty_report(set_of({}));
    CHECK(
        report.dump() ==
        R"({"axis":"u","kind":"insert","shape":[4,1,2,1],"energy":[],"zero_share":[],"wall_s":[]})");
    describe_seams(found, "", {std::nullopt, std::nullopt}, report);
    CHECK(report.at("energy").dump() == "[3.0,5.0]");
    CHECK(report.at("lower_bound").dump() == "[2.0,null]");
    CHECK(report.at("gap").dump() == "[0.5,null]");
    CHECK(!report.contains("attracted"));
    CHECK(!report.contains("protected"));
    describe_seams(found, "pair_", {no_vertex, few_vertices}, report);
    CHECK(report.at("pair_energy").dump() == "[3.0,5.0]");
    CHECK(report.at("pair_attracted").dump() == "[1,0]");
    CHECK(report.at("pair_protected").dump() == "[0,0]");
    CHECK(!report.contains("pair_gap"));
    CHECK(!report.contains("attracted_left"));
}

TEST_CASE("the time of a seam is that of all runs that looked for it or its pair") {
    const auto found = two_seams();
    FoundSeams pairs;
    pairs.wall_s = {0.0, 0.0, 4.0};
    CHECK(wall_seconds(nlohmann::ordered_json(), pairs, found) ==
          std::vector<double>{0.0, 0.5, 4.0});
    nlohmann::ordered_json before;
    before["wall_s"] = std::vector<double>{1.0, 2.0};
    CHECK(wall_seconds(before, pairs, found) == std::vector<double>{1.0, 2.5, 4.0});
}

TEST_CASE("the first seams of a set are reported as if no more had been found") {
    const auto found = two_seams();
    ReportedSeams all{std::make_shared<Seams>(set_of(found.seams)), empty_report(set_of({}))};
    describe_seams(found, "", {std::nullopt, few_vertices}, all.report);
    const auto one = all.first(1), none = all.first(0);
    CHECK(one.seams->seams.size() == 1);
    CHECK(one.seams->kind == Seams::Kind::insert);
    CHECK(one.report.at("energy").dump() == "[3.0]");
    CHECK(one.report.at("attracted_left").dump() == "[4]");
    CHECK(one.report.at("shape").size() == 4);
    CHECK(none.seams->seams.empty());
    CHECK(none.seams->kind == Seams::Kind::remove);
    CHECK(none.report.dump() == empty_report(*none.seams).dump());
    CHECK(all.first(3).report.dump() == all.report.dump());
    CHECK(all.seams->seams.size() == 2);
}

TEST_CASE("seams that meet nothing and masks that mark nothing are warned of") {
    auto set = set_of({});
    const auto warnings = [&] {
        auto report = empty_report(set);
        describe_seams(two_seams(), "", {std::nullopt, few_vertices}, report);
        return seam_warnings(report);
    };
    REQUIRE(warnings().size() == 1);
    CHECK(warnings()[0].find("1 of 2 seams takes no energy at all") == 0);
    // Only removals are to take all that is attracted.
    set.kind = Seams::Kind::remove;
    REQUIRE(warnings().size() == 2);
    CHECK(warnings()[1].find("1 of 2 seams take nothing of `attract`") == 0);
    CHECK(seam_warnings(empty_report(set)) ==
          std::vector<std::string>{"`count` comes to no seam: nothing is carved"});
    CHECK(mask_warnings({std::nullopt, few_vertices}).empty());
    CHECK(mask_warnings({no_vertex, no_vertex}) ==
          std::vector<std::string>{
              "`protect` is set around no vertex of the lattice: nothing is protected",
              "`attract` is set around no vertex of the lattice: nothing is attracted"});
}
