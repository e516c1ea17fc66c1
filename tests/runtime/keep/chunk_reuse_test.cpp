#include "carve/base/frame_set.h"
#include "graph/build_pipeline.h"
#include "runtime/run/forecast.h"
#include "runtime/run/run.h"
#include "runtime/run/status.h"
#include "tests/runtime/keep/reuse_cases.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <sys/resource.h>

using namespace fluidcarve;
namespace fs = std::filesystem;

TEST_CASE("a chunk looks at no file but those of its frames") {
    Shot shot;
    std::string fault;
    shot.replace("  top: {type: toy.top, number: square, count: 2}\n", "");
    shot.replace(", text: top", "");
    shot.request.target.frames = FrameSet::parse("2", fault);
    shot.run();
    const auto history = nlohmann::json::parse(Scratch::read(shot.folder + "/kept/history/p.json"));
    CHECK(history["load"]["files"].size() == 1);
    CHECK(history["load"]["files"].contains("2"));
}
