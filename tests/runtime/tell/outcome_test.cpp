#include "runtime/tell/outcome.h"
#include "runtime/flow/out_of_memory.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

TEST_CASE("the last words of a run say how much was made, in which time, and where it is") {
    CHECK(done_text({6, 12.34, false, {"out/plume/plume.####.vdb", "out/plume.png"}}) ==
          "done: 6 frames in 12.3 s -> out/plume/plume.####.vdb, out/plume.png");
    CHECK(done_text({1, 0.04, false, {}}) == "done: 1 frame in 0.0 s");
    CHECK(done_text({6, 0.1, true, {"out/a.####.vdb"}}) ==
          "done: nothing had to be done, all is there already: 6 frames -> out/a.####.vdb");
    CHECK(interrupted_text(true) == "interrupted; run it again to continue");
    CHECK(interrupted_text(false) == "interrupted; with --no-cache the next run begins anew");
}

TEST_CASE(
    "want of memory is told with what was done, and --in-flight only where several frames filled "
    "the memory") {
    constexpr std::uint64_t mb = 1000 * 1000;
    CHECK(out_of_memory(Phase::run, 5, {900 * mb, 100 * mb}) ==
          "out of memory while it ran: 5 frames were in flight; try a smaller --in-flight");
    CHECK(out_of_memory(Phase::digest, 5, {100 * mb, 900 * mb}) ==
          "out of memory while it took what it needs of the frame: it wanted more in one piece "
          "than is free (100 MB held by the run, 900 MB free); "
          "give it a smaller volume or a coarser lattice, or the run more memory");
    CHECK(out_of_memory(Phase::consume, 1, {900 * mb, 100 * mb}) ==
          "out of memory while it gathered the frame: it wanted more in one piece than is free "
          "(900 MB held by the run, 100 MB free); "
          "give it a smaller volume or a coarser lattice, or the run more memory");
    CHECK(out_of_memory(Phase::finish, 0, {900 * mb, 100 * mb}) ==
          "out of memory while it worked on all that it had gathered: it wanted more in one piece "
          "than is free (900 MB held by the run, 100 MB free); "
          "give it a smaller volume or a coarser lattice, or the run more memory");
    CHECK(memory_now().held > 0);
}
