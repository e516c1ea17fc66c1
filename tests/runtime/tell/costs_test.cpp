#include "runtime/tell/costs.h"

#include <catch2/catch.hpp>

#include <thread>

using namespace fluidcarve;

namespace {

void wait(int milliseconds) {
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
}

}  // namespace

TEST_CASE("while two bodies work at once, each counts for half of the time") {
    WorkTimes costs(std::vector<NodeCost>(2));
    const auto start = std::chrono::steady_clock::now();
    double first = 0, second = 0;
    {
        WorkTimes::Span one(costs);
        wait(20);
        WorkTimes::Span two(costs);
        wait(40);
        second = two.end();
        wait(20);
        first = one.end();
        CHECK(one.end() == first);
    }
    const double wall =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    CHECK(second >= 0.02);
    CHECK(first >= 0.06);
    CHECK(first + second <= wall);
}

TEST_CASE("of several calls the mean counts, and the latest setting") {
    std::vector<NodeCost> expected(1);
    expected[0][Work::consume] = WorkTime{3, {}};
    WorkTimes costs(expected);
    CHECK(costs.expected(0, Work::consume) == 3);
    CHECK(!costs.expected(0, Work::frame));
    CHECK(!costs.mean(0)[Work::frame]);
    costs.add(0, Work::frame, 1, {1, 1, 0, 0, 0, 0});
    costs.add(0, Work::frame, 3, {2, 2, 0, 0, 0, 0});
    const auto cost = costs.mean(0);
    REQUIRE(cost[Work::frame]);
    CHECK(cost[Work::frame]->seconds == 2);
    CHECK(cost[Work::frame]->at.abreast == 2);
    CHECK(!cost[Work::once]);
}

TEST_CASE("a time is carried over to other bytes, frames, items and threads") {
    const WorkTime twelve_seams{6, {4, 1, 1000, 10, 12, 100}};
    const auto in = [&](const CostSetting& now) { return seconds_in(twelve_seams, now); };
    CHECK(in({4, 1, 1000, 10, 12, 100}) == Approx(6));
    CHECK(in({4, 1, 1000, 10, 24, 100}) == Approx(12));
    CHECK(in({4, 1, 2000, 10, 12, 100}) == Approx(12));
    CHECK(in({4, 1, 1000, 5, 12, 100}) == Approx(3));
    // One core was busy: more threads do not help.
    CHECK(in({8, 1, 1000, 10, 12, 100}) == Approx(6));
    CHECK(in({4, 1, 0, 0, 0, 0}) == Approx(6));
    // All were.
    const WorkTime frames{6, {4, 4, 0, 0, 0, 0}};
    CHECK(seconds_in(frames, {2, 1, 0, 0, 0, 0}) == Approx(12));
    CHECK(seconds_in(frames, {8, 1, 0, 0, 0, 0}) == Approx(3));
    // One thread does not tell: half of the work is taken to gain.
    CHECK(seconds_in({6, {1, 1, 0, 0, 0, 0}}, {2, 1, 0, 0, 0, 0}) == Approx(4.5));
}
