#include "tests/support/program.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

/// The plume, with automatic ranges, a fitted box, a solver, frames, seams and a picture.
class Plume {
public:
    /// A command for a shell, with outputs and the work folder in a folder of this name.
    std::string command(const std::string& verb, const std::string& into,
                        const std::string& more = {},
                        const std::string& pipeline = "pipelines/plume.yaml") const {
        auto out = fmt::format("{} {} {} --set count=-3 --work {} {}", FLUIDCARVE_PROGRAM, verb,
                               pipeline, work(into), more);
        for (const auto& [param, file] :
             {std::pair("out", "o.####.vdb"), std::pair("seams", "seams.vdb"),
              std::pair("sheet", "sheet.png")})
            out += fmt::format(" --set {}={}", param, scratch / (into + "/" + file));
        return out;
    }
    std::string work(const std::string& into) const { return scratch / (into + "_work"); }

    /// The files of a folder, without temporary ones, by their names.
    std::set<std::string> files(const std::string& into) const {
        std::set<std::string> out;
        for (const auto& each : fs::directory_iterator(scratch / into))
            out.insert(each.path().filename().string());
        return out;
    }
    Json status(const std::string& into) const {
        return Json::parse(call_shell(FLUIDCARVE_PROGRAM " status --json --work " + work(into)).out)
            .at(0);
    }

    /// How many frames of each node all tasks computed, by their reports.
    std::map<std::string, int> computed() const {
        std::map<std::string, int> out;
        for (const auto& each : fs::directory_iterator(scratch / "reports")) {
            const auto report = Json::parse(Scratch::read(each.path()));
            for (const auto& [name, node] : report.at("nodes").items())
                out[name] += node.at("frames").get<int>() - node.at("cached").get<int>();
        }
        return out;
    }

    Scratch scratch;
};

}  // namespace

TEST_CASE("a farm on one machine makes what one run makes, and computes each energy once",
          "[long]") {
    const Plume plume;
    REQUIRE(call_shell(plume.command("run", "one", "-q")).code == 0);
    const auto farmed = call_shell(plume.command(
        "farm local", "many", "-j 2 --chunk 4 --report " + (plume.scratch / "reports/r.json")));
    INFO(farmed.err);
    REQUIRE(farmed.code == 0);
    CHECK_THAT(farmed.err,
               Catch::Contains("seams-energy.51-54: done in ") && Catch::Contains("\ndone: "));
    CHECK(plume.files("many") == plume.files("one"));
    // Each VDB file has a unique id of 36 bytes behind a head of 21.
    constexpr std::size_t head = 21, id = 36;
    for (const auto& file : plume.files("one")) {
        INFO(file);
        auto one = Scratch::read(plume.scratch / ("one/" + file)),
             many = Scratch::read(plume.scratch / ("many/" + file));
        if (file.ends_with(".vdb"))
            for (auto* const bytes : {&one, &many}) bytes->erase(head, id);
        CHECK(one == many);
    }
    const auto computed = plume.computed();
    for (const auto* const energy : {"edges", "energy"}) CHECK(computed.at(energy) == 6);
    CHECK(computed.at("out") == 6);
    CHECK(plume.status("many").at("state") == "done");

    // Once more: nothing is left to do.
    const auto again = call_shell(plume.command("farm local", "many", "-j 2 --chunk 4"));
    CHECK(again.code == 0);
}

TEST_CASE("a task of a farm that is killed runs again, and what was done stays done", "[nightly]") {
    const Plume plume;
    const auto killed = call_shell(plume.command("farm local", "out", "--chunk 2") +
                                   " & farm=$!; until child=$(pgrep -P $farm); do sleep 0.01; "
                                   "done; kill -9 $child; wait $farm");
    INFO(killed.err);
    CHECK(killed.code == 0);
    CHECK_THAT(killed.err, Catch::Contains("killed by signal 9; runs again"));
    CHECK(plume.status("out").at("state") == "done");
}

TEST_CASE("a farm that is stopped ends its tasks, and goes on when it is run again",
          "[nightly][long]") {
    const Plume plume;
    const auto stopped = call_shell(plume.command("farm local", "out", "--chunk 1") +
                                    " & farm=$!; until pgrep -P $farm >/dev/null; do sleep 0.01; "
                                    "done; kill -TERM $farm; wait $farm");
    CHECK(stopped.code == 130);
    CHECK_THAT(stopped.err, Catch::Contains("interrupted; to continue, run: cd ") &&
                                Catch::Contains(" farm local pipelines/plume.yaml "));
    CHECK(plume.status("out").at("state") != "done");
    CHECK(call_shell(plume.command("farm local", "out", "--chunk 1")).code == 0);
    CHECK(plume.status("out").at("state") == "done");
}

TEST_CASE(
    "a step that fails ends what needs it, and both the farm and status say why and how to go on",
    "[nightly][long]") {
    const Plume plume;
    // All smoke is protected, so that no seam passes the window: only the solver finds out.
    const auto shot = [&](const char* fields) {
        plume.scratch.write(
            "shot.yaml", fmt::format("extends: {}/pipelines/plume.yaml\nnodes: {{seams: {{{}}}}}\n",
                                     SOURCE_ROOT, fields));
    };
    const auto again = plume.command("farm local", "out", "--chunk 2", plume.scratch / "shot.yaml");
    shot("protect: sim.density, window: [15, 20]");
    const auto failed = call_shell(again);
    INFO(failed.err);
    CHECK(failed.code == 1);
    CHECK_THAT(failed.err, Catch::Contains("failed: seams: seams (seam.pyramid): ") &&
                               Catch::Contains("\n  its log: "));
    CHECK_THAT(failed.err, Catch::Contains("not run, since they need what failed: "));
    CHECK_THAT(failed.err, Catch::Contains("to continue, fix the cause, then run: cd "));
    const auto status = call_shell(FLUIDCARVE_PROGRAM " status --work " + plume.work("out"));
    CHECK_THAT(status.out, Catch::Contains("local): failed\n") &&
                               Catch::Contains("failed: seams: seams (seam.pyramid): ") &&
                               Catch::Contains("to continue, run: cd "));
    // The ends of tasks are seen, too, where the parent of the farm ignores those of its children.
    CHECK(call_shell("bash -c 'trap \"\" CHLD; exec " + again + "'").code == 1);
    shot("");
    CHECK(call_shell(again).code == 0);
    CHECK(plume.status("out").at("state") == "done");
    CHECK(plume.status("out").at("failures").empty());
}

TEST_CASE("a farm refuses what can't be, and makes nothing") {
    const Plume plume;
    const auto refused = [&](const std::string& verb, const std::string& more) {
        const auto called = call_shell(plume.command(verb, "out", more));
        CHECK(called.code != 0);
        CHECK(!fs::exists(plume.work("out")));
        CHECK(!fs::exists(plume.scratch / "out"));
        return called.err;
    };
    CHECK_THAT(refused("farm locla", ""),
               Catch::StartsWith("there is no farm engine 'locla'; did you mean 'local'?"));
    CHECK_THAT(refused("farm local", "--chunk 0"),
               Catch::StartsWith("--chunk 0: a task takes at least 1 frame"));
    CHECK_THAT(refused("farm local", "--minutes 0"), Catch::StartsWith("--minutes 0: "));
    CHECK_THAT(refused("farm local", "--no-cache"), Catch::StartsWith("--no-cache: "));
    CHECK_THAT(refused("farm local", "--set energy.field=sim.densty"), Catch::Contains("densty"));
    CHECK_THAT(refused("farm local", "--set sim=nowhere.####.vdb"),
               Catch::Contains("nowhere.0051.vdb"));
    const auto unwritable = call_shell(
        FLUIDCARVE_PROGRAM " farm local pipelines/plume.yaml --work /proc/none --set out=" +
        (plume.scratch / "o.####.vdb"));
    CHECK(unwritable.code == 1);
    CHECK_THAT(unwritable.err, Catch::StartsWith("failed: cannot make the work folder /proc/none"));
}

TEST_CASE("a dry run shows the steps and makes nothing") {
    const Plume plume;
    const auto shown = call_shell(plume.command(
        "farm local", "out", "--chunk 4 --dry-run --json --prefix 'rez-env fluidcarve --'"));
    INFO(shown.err);
    REQUIRE(shown.code == 0);
    CHECK(!fs::exists(plume.work("out")));
    std::map<std::string, Json> steps;
    const auto job = Json::parse(shown.out);
    for (const auto& step : job.at("steps")) steps[step.at("name")] = step;
    CHECK(steps.at("seams").at("needs") == Json{"seams-energy"});
    CHECK(steps.at("seams-energy").at("tasks") == 2);
    CHECK(steps.at("out").at("frames") == "51-56");
    const auto command = steps.at("out").at("command").get<std::vector<std::string>>();
    CHECK(command.at(0) == "rez-env");
    CHECK(command.at(3) == "fluidcarve");
    CHECK(command.back() == "--frames=51-54");
    const auto skips =
        call_shell(plume.command("farm local", "out", "--dry-run --missing skip")).out;
    CHECK_THAT(skips, Catch::Contains(" --missing skip "));
    const auto named = call_shell("FLUIDCARVE_EXECUTABLE=/opt/f " +
                                  plume.command("farm local", "out", "--dry-run"));
    CHECK_THAT(named.out, Catch::Contains("\n  /opt/f run pipelines/plume.yaml "));
}

TEST_CASE("tasks load the plugins that the farm was trusted to load") {
    const Plume plume;
    const auto pipeline = plume.scratch.write("p.yaml", "fluidcarve: 1\nplugins: [" PLUGINS
                                                        "/whole.so]\nextends: " SOURCE_ROOT
                                                        "/pipelines/plume.yaml\n");
    const auto first_words = [&](const std::string& before, const std::string& more) {
        const auto called =
            call_shell(before + FLUIDCARVE_PROGRAM " farm local " + pipeline +
                       " --dry-run --json --work " + (plume.scratch / "work") + more);
        INFO(called.err);
        REQUIRE(called.code == 0);
        const auto job = Json::parse(called.out);
        return job.at("steps").at(0).at("command").get<std::vector<std::string>>();
    };
    const auto by_folder = first_words("FLUIDCARVE_PLUGINS='" PLUGINS "' ", "");
    CHECK(by_folder.at(0) == "env");
    CHECK(by_folder.at(1) == "FLUIDCARVE_PLUGINS=" PLUGINS);
    const auto by_option = first_words("", " --allow-plugins");
    CHECK(std::ranges::find(by_option, "--allow-plugins") != by_option.end());
    CHECK(by_option.at(0) != "env");
}

TEST_CASE("tasks are as long as is asked for, by earlier runs") {
    const Plume plume;
    const auto tasks = [&](const std::string& minutes, const std::string& warning) {
        const auto shown = call_shell(
            plume.command("farm local", "out", "--to seams --dry-run --json --minutes " + minutes));
        CHECK(shown.err == warning);
        std::size_t out = 0;
        const auto job = Json::parse(shown.out);
        for (const auto& step : job.at("steps"))
            if (step.at("name") == "seams-energy") out = step.at("tasks").get<std::size_t>();
        return out;
    };
    CHECK(tasks("0.00001",
                "warning: --minutes 1e-05: the time per frame is not measured yet in "
                "sharp-energy, box-fit, seams-energy; 10 frames a task\n") == 1);
    REQUIRE(call_shell(plume.command("run", "out", "-q --to seams")).code == 0);
    CHECK(tasks("0.00001", "") == 6);
    CHECK(tasks("60", "") == 1);
}

TEST_CASE("a task waits for what others make, and says so if it does not come") {
    const Plume plume;
    const auto waited =
        call_shell(plume.command("run", "out", "--to seams.energy -f 52 --wait 0.6"));
    CHECK(waited.code == 3);
    CHECK_THAT(
        waited.err,
        Catch::Contains(
            "failed: sharp (energy.remap): the data of 6 of 6 frames are not in the work folder") &&
            Catch::Contains("after 0.6 s of --wait"));
    const auto late = call_shell(
        "( sleep 1; for step in sharp.energy box.fit; do " +
        plume.command("run", "out", "-q --to $step") + "; done ) & " +
        plume.command("run", "out", "--to seams.energy -f 52 --wait 60 --progress plain") +
        "; code=$?; wait; exit $code");
    INFO(late.err);
    CHECK(late.code == 0);
    CHECK_THAT(late.err, Catch::Contains(": frame 52\n"));
}

TEST_CASE("progress for Open Job Description is its lines, on stdout") {
    const Plume plume;
    const auto ran = call_shell(plume.command("run", "out", "--to sharp.energy --progress openjd"));
    CHECK(ran.code == 0);
    CHECK_THAT(ran.out, Catch::Contains("openjd_progress: 100.0\nopenjd_status: pass "));
    CHECK(ran.err.find("openjd") == std::string::npos);
}

TEST_CASE("a task whose job is not in its work folder says so") {
    const Plume plume;
    const auto ran = call_shell(plume.command("run", "out", "--task plume-123456/out --wait 0"));
    CHECK(ran.code == 3);
    CHECK_THAT(ran.err, Catch::StartsWith("failed: --task plume-123456/out: there is no folder ") &&
                            Catch::Contains("share the work folder with this machine"));
    CHECK(call_shell(plume.command("run", "out", "--task ../x")).err ==
          "--task ../x: must be JOB/STEP, each of letters, digits, - and _\n");
}
