#include "runtime/tell/progress.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

TEST_CASE(
    "the share that is shown never falls, though what is left turns out longer, and ends at one") {
    Progress progress(ProgressStyle::none, 1);
    const auto quick = progress.add({"quick", 3, std::nullopt});
    const auto solve = progress.add({"solve", 1, std::nullopt});
    CHECK(progress.fraction() == 0);
    for (int frame = 1; frame <= 3; ++frame) progress.done(quick, 1, frame);
    // Without an expectation the solver counts as one frame more.
    CHECK(progress.fraction() == Approx(0.75));
    double last = progress.fraction();
    progress.part(solve, 0.1, 10);
    CHECK(progress.fraction() == Approx(0.75));
    for (const double part : {0.3, 0.5, 0.8}) {
        progress.part(solve, part, 100 * part);
        const double now = progress.fraction();
        CHECK(now > last);
        last = now;
    }
    progress.done(solve, 100, std::nullopt);
    CHECK(progress.fraction() == Approx(1));
}

TEST_CASE("with expected times the share is that of the whole run from the first frame on") {
    Progress progress(ProgressStyle::none, 1);
    const auto quick = progress.add({"quick", 3, 1.0});
    const auto solve = progress.add({"solve", 1, 97.0});
    for (int frame = 1; frame <= 3; ++frame) progress.done(quick, 1, frame);
    CHECK(progress.fraction() == Approx(0.03));
    progress.part(solve, 0.5, 48.5);
    CHECK(progress.fraction() == Approx(0.515));
}

TEST_CASE("a run that begins again begins with what was shown") {
    Progress progress(ProgressStyle::none, 1);
    const auto first = progress.add({"count", 4, std::nullopt});
    for (int frame = 1; frame <= 2; ++frame) progress.done(first, 1, frame);
    CHECK(progress.fraction() == Approx(0.5));
    progress.begin_again();
    const auto again = progress.add({"count", 4, std::nullopt});
    CHECK(progress.fraction() == Approx(0.5));
    for (int frame = 1; frame <= 2; ++frame) progress.done(again, 1, frame);
    CHECK(progress.fraction() == Approx(0.75));
}
