#include "runtime/run/task.h"

#include <catch2/catch.hpp>

#include <optional>
#include <string>

using namespace fluidcarve;

TEST_CASE("a step of a job is read from JOB/STEP, and from nothing else") {
    const auto step = JobStep::parse("plume-1/seams_2");
    REQUIRE(step);
    CHECK(step->job == "plume-1");
    CHECK(step->step == "seams_2");
    CHECK(step->text() == "plume-1/seams_2");
    for (const std::string bad :
         {"", "plume", "/seams", "plume/", "../x", "a/b/c", "a b/c", "a/ü"}) {
        INFO(bad);
        CHECK(!JobStep::parse(bad));
    }
}

TEST_CASE("a task is named, and recorded, by its step and its first and last frame") {
    CHECK(task_name("seams", std::nullopt) == "seams");
    CHECK(task_name("energy", FrameSet({1001})) == "energy.1001");
    CHECK(task_name("energy", FrameSet({1001, 1003, 1010})) == "energy.1001-1010");
    CHECK(task_record("work", {"plume", "energy"}, FrameSet({7, 8})) ==
          job_folder("work", "plume") + "/tasks/energy.7-8.json");
    CHECK(job_folder("work", "plume") == "work/jobs/plume");
}
