#include "carve/time/pace.h"

#include "carve/base/failure.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

namespace {

PaceRequest at_speed(double speed) {
    PaceRequest out;
    out.speed = speed;
    return out;
}

/// The frame of the source that a frame shows.
double shown(const Pace& pace, const std::vector<int>& source, int frame) {
    const auto moment = pace.moment(frame);
    const double from = source.at(moment.place);
    return moment.share == 0 ? from : from + moment.share * (source.at(moment.place + 1) - from);
}

}  // namespace

TEST_CASE(
    "at half the speed a sequence has twice the frames, and every second one is one of its own") {
    const std::vector<int> source{1, 2, 3, 4, 5, 6, 7, 8, 9};
    const Pace slow(at_speed(0.5), source);
    CHECK(slow.frames().size() == 17);
    CHECK(slow.frames().front() == 1);
    CHECK(slow.moment(3).place == 1);
    CHECK(slow.moment(3).share == 0);
    CHECK(slow.moment(4).place == 1);
    CHECK(slow.moment(4).share == Approx(0.5));
    CHECK(slow.moment(17).place == 8);
    CHECK(slow.moment(17).share == 0);
    for (const int frame : slow.frames()) CHECK(slow.moment(frame).rate == Approx(0.5));
}

TEST_CASE("speed 1 is the source, also on twos, and a hole in it is filled") {
    for (const std::vector<int>& source :
         {std::vector{5}, std::vector{3, 4, 5}, std::vector{1, 3, 5, 7}}) {
        const Pace same(at_speed(1), source);
        CHECK(same.frames() == source);
        for (const int frame : source) CHECK(shown(same, source, frame) == frame);
    }
    const std::vector<int> holed{1, 2, 4};
    const Pace filled(at_speed(1), holed);
    CHECK(filled.frames() == std::vector{1, 2, 3, 4});
    CHECK(shown(filled, holed, 3) == Approx(3));
}

TEST_CASE("a speed of 0 makes no endless sequence") {
    CHECK(Pace(at_speed(0), {41}).frames() == std::vector{41});
    CHECK_THROWS_AS(Pace(at_speed(0), {41, 42}), Failure);
}

TEST_CASE("time runs backwards, faster, to a wished length, and from a wished frame") {
    const std::vector<int> source{1, 2, 3, 4, 5};
    auto request = at_speed(-2);
    request.start = 100;
    const Pace back(request, source);
    CHECK(back.frames() == std::vector{100, 101, 102});
    CHECK(shown(back, source, 100) == 5);
    CHECK(shown(back, source, 102) == 1);
    CHECK(back.moment(101).rate == Approx(-2));
    PaceRequest length;
    length.count = 9;
    const Pace longer(length, source);
    CHECK(longer.frames().size() == 9);
    CHECK(shown(longer, source, 9) == 5);
    CHECK(shown(longer, source, 2) == Approx(1.5));
    CHECK(longer.moment(2).rate == Approx(0.5));
    length.count = 1;
    CHECK(shown(Pace(length, source), source, 1) == 1);
}

TEST_CASE("a curve holds, jumps to another speed and says which frames there are") {
    const std::vector<int> source{1, 2, 3, 4, 5};
    PaceRequest request;
    request.curve = {{10, 1}, {12, 5}, {15, 5}, {16, 3}};
    const Pace pace(request, source);
    CHECK(pace.frames() == std::vector{10, 11, 12, 13, 14, 15, 16});
    CHECK(shown(pace, source, 11) == 3);
    CHECK(pace.moment(11).rate == Approx(2));
    CHECK(shown(pace, source, 13) == 5);
    CHECK(pace.moment(13).rate == 0);
    CHECK(shown(pace, source, 16) == 3);
    request.curve.push_back({20, 6});
    CHECK_THROWS_WITH(Pace(request, source),
                      "the curve leads to frame 6 of the source, which has the frames 1 to 5");
    request.curve = {{1, 2, 3}};
    CHECK_THROWS_WITH(Pace(request, source), "a point of 'curve' is [frame, frame of the source]");
    CHECK_THROWS_WITH(Pace(PaceRequest(), source), Catch::Contains("is stated"));
    CHECK_THROWS_WITH(Pace(at_speed(1e-6), source), Catch::Contains("a million are the most"));
    request.curve = {{1e12, 1}};
    CHECK_THROWS_WITH(Pace(request, source), "the curve's frame 1e+12 is no frame number");
}
