#include "runtime/run/run.h"
#include "carve/base/frame_set.h"
#include "graph/build_pipeline.h"
#include "graph/types/node_type.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace fluidcarve;

namespace {

/// Waits in each frame until another frame is here, too.
struct Meet {
    struct Ports {
        Ref<toy::Number> number;
    };
    static inline std::atomic<int> inside{0};  ///< frames that have come
    static NodeTraits traits(const detail::NoParams&) { return {.animates = true}; }
    static void run(const detail::NoParams&, Ports& io, Context& context) {
        ++inside;
        const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(10);
        while (inside < 2) {
            if (std::chrono::steady_clock::now() > until)
                throw Failure("no other frame is at work");
            std::this_thread::yield();
        }
        io.number = std::make_shared<toy::Number>(context.frame());
    }
};

Registry registry_with_meet() {
    auto out = toy::registry();
    out.add(NodeType(Declare<Meet>("toy.meet", "Waits for another frame.")
                         .output("number", &Meet::Ports::number, "The frame's number.")));
    return out;
}

struct Ran {
    int code = 0;
    nlohmann::json report;
    std::vector<std::string> log;  ///< sorted

    std::size_t count(const std::string& prefix) const {
        return static_cast<std::size_t>(std::ranges::count_if(
            log, [&](const std::string& line) { return line.starts_with(prefix); }));
    }
};

Ran run(
    const std::string& yaml, RunRequest request = {},
    const std::function<bool()>& cancelled = [] { return false; }) {
    static const Registry registry = registry_with_meet();
    toy::log.reset();
    const Scratch scratch;
    Problems problems;
    const auto pipeline = build_pipeline(
        read_document(scratch.write("p.yaml", "fluidcarve: 1\n" + yaml), {}, problems), registry,
        problems);
    REQUIRE(to_text(problems) == "");
    request.options.threads = 4;
    if (request.options.in_flight == 2) request.options.in_flight = 5;
    request.report_path = scratch / "report.json";
    request.quiet = true;
    request.options.work_folder = scratch / "work";
    Ran out;
    out.code = run_pipeline(pipeline, registry, request, cancelled);
    out.report = nlohmann::json::parse(Scratch::read(request.report_path));
    out.log = toy::log.sorted();
    CHECK(out.report["exit"] == out.code);
    return out;
}

const std::string two_passes = R"(
frames: 1-6
nodes:
  count: {type: toy.count, path: in.##}
  total: {type: toy.total, number: count}
  print: {type: toy.print, number: count, total: total, path: out.##}
)";

RunRequest deliver(const std::string& frames) {
    std::string fault;
    RunRequest out;
    out.target.frames = FrameSet::parse(frames, fault);
    return out;
}

RunRequest keep_going() {
    RunRequest out;
    out.options.keep_going = true;
    return out;
}

std::vector<std::string> failures(const Ran& ran) {
    std::vector<std::string> out;
    for (const auto& failure : ran.report["failures"])
        out.push_back(failure["node"].get<std::string>() + " " +
                      (failure.contains("frame") ? failure["frame"].dump() : "-") + ": " +
                      failure["message"].get<std::string>());
    return out;
}

}  // namespace

TEST_CASE("what a gathering node finds over all frames reaches every frame") {
    const auto ran = run(two_passes);
    CHECK(ran.code == exit_code::done);
    CHECK(ran.count("finish 6") == 1);
    CHECK(ran.count("total ") == 6);
    for (int frame = 1; frame <= 6; ++frame)
        CHECK(ran.count(fmt::format("print {0} = {0} of 21", frame)) == 1);
    CHECK(ran.report["frames"] == nlohmann::json({1, 2, 3, 4, 5, 6}));
    CHECK(ran.report["nodes"]["count"]["frames"] == 6);
    CHECK(ran.report["nodes"]["print"]["frames"] == 6);
    CHECK(ran.report["totals"]["total"]["sum"] == 21);
}

TEST_CASE("what a node that runs once has made is given up as soon as its last reader has run") {
    const auto ran = run(R"(
nodes:
  count: {type: toy.count, path: in}
  one:   {type: toy.add, numbers: count}
  two:   {type: toy.add, numbers: one}
  three: {type: toy.add, numbers: two}
  late:  {type: toy.add, numbers: [one, three]}
  print: {type: toy.print, number: late, path: printed.txt}
)");
    CHECK(ran.code == exit_code::done);
    CHECK(ran.count("print 1 = 2") == 1);
    // `one` is still there when `late` reads it, `count` and `two` no more.
    CHECK(toy::Number::most_alive == 3);
}

TEST_CASE("the option -f limits what is delivered, never what a gathering node sees") {
    const auto ran = run(two_passes, deliver("2,5"));
    CHECK(ran.code == exit_code::done);
    CHECK(ran.count("total ") == 6);
    CHECK(ran.count("print ") == 2);
    CHECK(ran.count("print 5 = 5 of 21") == 1);
    CHECK(ran.report["frames"] == nlohmann::json({2, 5}));
}

TEST_CASE(
    "a gathering node may also run per frame with what it gathered, or need no gathering at all") {
    const std::string yaml = R"(
frames: 1-4
nodes:
  count: {type: toy.count, path: in.##}
  share: {type: toy.share, number: count, stated: STATED}
  print: {type: toy.print, number: share, path: out.##}
)";
    const auto with = [&](const std::string& stated) {
        return std::string(yaml).replace(yaml.find("STATED"), 6, stated);
    };
    auto ran = run(with("false"));
    CHECK(ran.count("print 1 = 0.25") == 1);
    CHECK(ran.count("count ") == 8);
    ran = run(with("true"));
    CHECK(ran.count("print 3 = 3") == 1);
    CHECK(ran.count("count ") == 4);
}

TEST_CASE("a gathering node is given only the frames that it takes") {
    const auto ran = run(R"(
frames: 1-9
nodes:
  count: {type: toy.count, path: in.##}
  total: {type: toy.total, number: count, only_place: 4}
)");
    CHECK(ran.code == exit_code::done);
    CHECK(ran.log == std::vector<std::string>{"count 5", "finish 1", "total 5"});
}

TEST_CASE("with --to only a node and what it needs run") {
    RunRequest request;
    request.target.to = "total";
    const auto ran = run(two_passes, request);
    CHECK(ran.count("print") == 0);
    CHECK(ran.count("finish") == 1);
}

TEST_CASE("a result that --to asks for and that is kept under no key fails the run") {
    // The files of toy.count are not there, so that their contents are unknown.
    const std::string squares =
        "frames: 1-2\nnodes:\n  count: {type: toy.count, path: in.##}\n  square: {type: "
        "toy.square, number: count}\n";
    RunRequest request;
    request.target.to = "square";
    const auto asked = run(squares, request);
    CHECK(asked.code == exit_code::node_failed);
    REQUIRE(failures(asked).size() == 1);
    CHECK_THAT(failures(asked).front(),
               Catch::StartsWith("square -: its results could not be kept for other runs: ") &&
                   Catch::EndsWith("in.01 could not be read when the run began, so that nothing "
                                   "tells its content; run again"));
    request.options.cache = false;
    CHECK(run(squares, request).code == exit_code::done);
    request.options.cache = true;
    const auto unkept = "{type: toy.square, cache: false, number: count}";
    CHECK(run(squares.substr(0, squares.find("{type: toy.square")) + unkept + "\n", request).code ==
          exit_code::done);
}

TEST_CASE("frames alive never exceed --in-flight, whatever arrives late") {
    for (const int limit : {1, 3, 8}) {
        RunRequest request;
        request.options.in_flight = limit;
        const auto ran = run(R"(
frames: 1-1000
nodes:
  count: {type: toy.count, path: in.##, late: true}
  total: {type: toy.total, number: count}
  print: {type: toy.print, number: count, total: total, path: out.##}
)",
                             request);
        CHECK(ran.code == exit_code::done);
        CHECK(ran.count("total ") == 1000);
        CHECK(ran.count("print ") == 1000);
        // One more is alive: the total itself.
        CHECK(toy::Number::most_alive <= limit + 1);
        CHECK(toy::Number::alive == 0);
    }
}

TEST_CASE("frames run at the same time: one that waits for the next goes on when that has begun") {
    Meet::inside = 0;
    const auto ran = run(R"(
frames: 1-2
nodes:
  count: {type: toy.meet}
  print: {type: toy.print, number: count, path: out.##}
)");
    CHECK(ran.code == exit_code::done);
    CHECK(ran.count("print ") == 2);
}

TEST_CASE("a failed frame admits no new frames, and the exit code says so") {
    const auto ran = run(R"(
frames: 1-500
nodes:
  count: {type: toy.count, path: in.##, fail_at: 20}
  print: {type: toy.print, number: count, path: out.##}
)");
    CHECK(ran.code == exit_code::node_failed);
    CHECK(ran.count("print ") < 500);
    CHECK(ran.count("print ") >= 15);
    CHECK(failures(ran) == std::vector<std::string>{"count 20: made to fail"});
}

TEST_CASE("with --keep-going all other frames arrive") {
    const auto ran = run(R"(
frames: 1-200
nodes:
  count: {type: toy.count, path: in.##, fail_at: 20, late: true}
  more: {type: toy.add, numbers: [count], throw_at: 70}
  print: {type: toy.print, number: more, path: out.##}
)",
                         keep_going());
    CHECK(ran.code == exit_code::some_frames_failed);
    CHECK(ran.count("print ") == 198);
    CHECK(failures(ran) ==
          std::vector<std::string>{"count 20: made to fail", "more 70: a library threw"});
}

TEST_CASE("a gathering node never finishes with a failed frame") {
    const std::string yaml = R"(
frames: 1-50
nodes:
  count: {type: toy.count, path: in.##, fail_at: 20}
  total: {type: toy.total, number: count}
  print: {type: toy.print, number: count, total: total, path: out.##}
)";
    auto ran = run(yaml, keep_going());
    CHECK(ran.code == exit_code::node_failed);
    CHECK(ran.count("total ") == 49);
    CHECK(ran.count("finish") + ran.count("print") == 0);
    CHECK(failures(ran) == std::vector<std::string>{
                               "count 20: made to fail",
                               "total -: needs every frame of the sequence, but these failed: 20"});
    ran = run(yaml);
    CHECK(ran.code == exit_code::node_failed);
    CHECK(ran.count("finish") + ran.count("print") == 0);
}

TEST_CASE("missing input is told before anything runs, or frame by frame with --keep-going") {
    const std::string yaml = R"(
frames: 1-9
nodes:
  count: {type: toy.count, path: in.##, fail_at: 4, missing: true}
  print: {type: toy.print, number: count, path: out.##}
)";
    auto ran = run(yaml);
    CHECK(ran.code == exit_code::input);
    CHECK(ran.log.empty());
    CHECK(failures(ran) == std::vector<std::string>{"count 4: the file is not there"});
    ran = run(yaml, keep_going());
    CHECK(ran.code == exit_code::some_frames_failed);
    CHECK(ran.count("print ") == 8);
}

TEST_CASE(
    "a file that is missing outside of what -f delivers is no matter, unless a gathering node "
    "needs it") {
    const std::string yaml = R"(
frames: 1-9
nodes:
  count: {type: toy.count, path: in.##, fail_at: 4, missing: true}
  print: {type: toy.print, number: count, path: out.##}
)";
    auto ran = run(yaml, deliver("5-6"));
    CHECK(ran.code == exit_code::done);
    CHECK(ran.count("print ") == 2);
    ran = run(yaml + "  total: {type: toy.total, number: count}\n", deliver("5-6"));
    CHECK(ran.code == exit_code::input);
}

TEST_CASE("a frame that a reader leaves out is left out everywhere") {
    const auto ran = run(R"(
frames: 1-5
nodes:
  count: {type: toy.count, path: in.##, skip: 3}
  total: {type: toy.total, number: count}
  print: {type: toy.print, number: count, total: total, path: out.##}
)");
    CHECK(ran.code == exit_code::done);
    CHECK(ran.report["frames"] == nlohmann::json({1, 2, 4, 5}));
    CHECK(ran.count("print 4 = 4 of 12") == 1);
}

TEST_CASE("a frame that -f names and a reader leaves out is warned of") {
    const std::string yaml = R"(
frames: 1-5
nodes:
  count: {type: toy.count, path: in.##, skip: 3}
  print: {type: toy.print, number: count, path: out.##}
)";
    const nlohmann::json warned = {
        {{"node", "count"},
         {"message", "left out because their files are missing, though -f names them: 3"}}};
    auto ran = run(yaml, deliver("3"));
    CHECK(ran.code == exit_code::done);
    CHECK(ran.log.empty());
    CHECK(ran.report["frames"].empty());
    CHECK(ran.report["warnings"] == warned);
    ran = run(yaml, deliver("2-3"));
    CHECK(ran.report["frames"] == nlohmann::json({2}));
    CHECK(ran.report["warnings"] == warned);
    ran = run(yaml, deliver("4"));
    CHECK(ran.report["warnings"].empty());
}

TEST_CASE(
    "an output that can't be written is told before anything runs, or frame by frame with "
    "--keep-going") {
    const std::string yaml = R"(
frames: 1-3
nodes:
  count: {type: toy.count, path: in.##}
  print: {type: toy.print, number: count, path: /proc/nowhere/out.##}
)";
    auto ran = run(yaml, deliver("2-3"));
    CHECK(ran.code == exit_code::node_failed);
    CHECK(ran.log.empty());
    CHECK(failures(ran) ==
          std::vector<std::string>{"print 2: cannot write /proc/nowhere/out.02: the folder "
                                   "/proc/nowhere cannot be made: No such file or directory"});
    ran = run(yaml, keep_going());
    CHECK(ran.count("print ") == 3);
}

TEST_CASE("a run that is asked to stop ends with what is in flight") {
    std::atomic<int> asked{0};
    const auto ran = run(R"(
frames: 1-1000
nodes:
  count: {type: toy.count, path: in.##}
  print: {type: toy.print, number: count, path: out.##}
)",
                         {}, [&] { return ++asked > 100; });
    CHECK(ran.code == exit_code::interrupted);
    CHECK(ran.count("print ") < 1000);
    CHECK(ran.report["failures"].empty());
}
