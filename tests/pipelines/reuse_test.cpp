#include "formats/vdb/vdb_file.h"
#include "tests/support/grid_bytes.h"
#include "tests/support/program.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <random>

using namespace fluidcarve;
namespace fs = std::filesystem;
using nlohmann::json;

namespace {

const std::string source_root = SOURCE_ROOT;
constexpr int first_kept = 41, last_kept = 44;

/// Four frames of the vortex in a folder of their own, with pipelines/vortex.yaml.
struct Shot {
    Scratch scratch;
    std::string folder = scratch / "shot";
    json plan, report;

    Shot() {
        fs::create_directories(folder + "/sim");
        for (int frame = first_kept; frame <= last_kept; ++frame)
            fs::copy_file(data(frame), input(frame));
        auto text = Scratch::read(source_root + "/pipelines/vortex.yaml");
        const auto replace = [&](const std::string& from, const std::string& to) {
            text.replace(text.find(from), from.size(), to);
        };
        replace("tests/data/vortex/", "sim/");
        replace("frames: 41-46", fmt::format("frames: {}-{}", first_kept, last_kept));
        replace("show: render", "show: maximum");  // quicker
        std::ofstream(folder + "/p.yaml") << text;
    }
    static std::string data(int frame) {
        return fmt::format("{}/tests/data/vortex/vortex.{:04}.vdb", source_root, frame);
    }
    std::string input(int frame) const {
        return fmt::format("{}/sim/vortex.{:04}.vdb", folder, frame);
    }
    std::string command(const std::string& arguments) const {
        return fmt::format("cd {} && exec {} run p.yaml --work work -q {}", folder,
                           FLUIDCARVE_PROGRAM, arguments);
    }
    json planned(const std::string& arguments) const {
        const auto called = call_shell(fmt::format("cd {} && {} plan p.yaml --work work --json {}",
                                                   folder, FLUIDCARVE_PROGRAM, arguments));
        INFO(called.err);
        REQUIRE(called.code == 0);
        return json::parse(called.out);
    }
    /// Which nodes computed something, each with the number of frames; and the plan had said so.
    std::map<std::string, int> run(const std::string& arguments = "") {
        plan = planned(arguments);
        const auto called = call_shell(command("--report report.json " + arguments));
        INFO(called.err);
        REQUIRE(called.code == 0);
        report = json::parse(Scratch::read(folder + "/report.json"));
        std::map<std::string, int> out;
        for (const auto& [name, node] : report["nodes"].items()) {
            INFO(name);
            CHECK(plan["nodes"][name]["frames"] == node["frames"]);
            CHECK(plan["nodes"][name]["cached"] == node["cached"]);
            if (const int computed = node["frames"].get<int>() - node["cached"].get<int>();
                computed > 0)
                out[name] = computed;
        }
        CHECK(plan["nodes"].size() == report["nodes"].size());
        return out;
    }
};

/// All of the grids of the carved frames and of the seams, byte for byte.
std::string results(const std::string& folder) {
    openvdb::initialize();
    std::string out;
    std::vector<std::string> files{folder + "/out/vortex_seams.vdb"};
    for (int frame = first_kept; frame <= last_kept; ++frame)
        files.push_back(fmt::format("{}/out/vortex.{:04}.vdb", folder, frame));
    for (const auto& file : files)
        for (const auto& grid : read_vdb(file).grids)
            out += grid->getName() + test::bytes(grid->constBaseTree()) +
                   test::bytes(grid->transform());
    return out;
}

std::vector<fs::path> files_below(const std::string& folder) {
    std::vector<fs::path> out;
    for (const auto& each : fs::recursive_directory_iterator(folder))
        if (each.is_regular_file()) out.push_back(each.path());
    std::ranges::sort(out);
    return out;
}

using Ran = std::map<std::string, int>;

}  // namespace

TEST_CASE("of the vortex, only what changed is computed, and the plan says so before", "[long]") {
    Shot shot;
    CHECK(shot.run().size() == 11);
    const auto whole = results(shot.folder);
    CHECK(shot.run() == Ran{});
    CHECK(shot.report["seams"]["seams"]["energy"].size() == 6);

    // A smaller count is part of the seams that are known, a larger one goes on from them.
    CHECK(shot.run("--set count=-4") ==
          Ran{{"carved", 4}, {"kept", 1}, {"out", 4}, {"sheet", 3}, {"sim", 4}});
    CHECK(shot.report["seams"]["seams"]["energy"].size() == 4);
    CHECK(shot.run("--set count=-7").count("seams") == 1);
    CHECK(shot.plan["nodes"]["seams"]["why"] ==
          "count changed from -4 to -7; goes on from 6 of 7 seams");
    CHECK(shot.plan["nodes"]["seams"]["taken"] == json({{"frames", 4}, {"cached", 4}}));

    // Another exponent: what is bent, smoothed, solved, carved and written; not the edges that are
    // bent.
    const Ran bent{{"carved", 4}, {"energy", 4}, {"kept", 1},  {"out", 4},
                   {"seams", 4},  {"sharp", 4},  {"sheet", 3}, {"sim", 4}};
    CHECK(shot.run("--set sharp.gamma=1.5") == bent);
    CHECK(shot.plan["nodes"]["sharp"]["why"] == "gamma changed from 2 to 1.5");

    // One frame of the input: its own work, and what gathers it.
    shot.run();
    CHECK(results(shot.folder) == whole);
    fs::copy_file(Shot::data(last_kept + 1), shot.input(43), fs::copy_options::overwrite_existing);
    auto replaced = bent;
    replaced.insert({{"edges", 1}});
    CHECK(shot.run() == replaced);
    CHECK(shot.plan["nodes"]["sim"]["why"] == "input frame 43 changed");
    CHECK(results(shot.folder) != whole);
    fs::copy_file(Shot::data(43), shot.input(43), fs::copy_options::overwrite_existing);
    const Ran carved{{"carved", 4}, {"kept", 1}, {"out", 4}, {"sheet", 3}, {"sim", 4}};
    CHECK(shot.run() == carved);
    CHECK(results(shot.folder) == whole);

    // Nothing that matters.
    auto text = Scratch::read(shot.folder + "/p.yaml");
    text.replace(text.find("doc: Input sequence."), 20, "doc: What comes in.") += "\n# a comment\n";
    std::ofstream(shot.folder + "/p.yaml") << text;
    fs::rename(shot.folder, shot.scratch / "elsewhere");
    shot.folder = shot.scratch / "elsewhere";
    CHECK(shot.run() == Ran{});
}

TEST_CASE(
    "the results of a shot are cleaned by its name, and what it needs for its next run is made "
    "again") {
    Shot shot;
    const auto clean = [&](const std::string& name) {
        return call_shell(fmt::format("cd {} && {} clean --work work --shot {}", shot.folder,
                                      FLUIDCARVE_PROGRAM, name))
            .out;
    };
    shot.run("--set count=-1");
    CHECK(clean("q").starts_with("work: nothing to clean; "));
    CHECK(shot.run("--set count=-1") == Ran{});
    CHECK(clean("p").starts_with("work: removed "));
    CHECK(clean("p").starts_with("work: nothing to clean; "));
    CHECK(shot.run("--set count=-2").contains("energy"));
}

TEST_CASE(
    "a run that is killed again and again ends like one that was not, and repeats nothing that was "
    "kept",
    "[nightly][long]") {
    Shot calm, killed;
    calm.run();
    std::mt19937 random(7);
    std::map<std::string, int> known;
    for (int n = 0; n < 10; ++n) {
        const double seconds = std::uniform_real_distribution(0.02, 0.5)(random);
        call_shell(fmt::format("{} & process=$!; sleep {:.3f}; kill -9 $process; wait $process",
                               killed.command("--threads 2"), seconds));
        const auto plan = killed.planned("");
        for (const auto* const name : {"edges", "energy", "out"}) {
            INFO(name << " after " << seconds);
            const int cached = plan["nodes"][name]["cached"];
            CHECK(cached >= known[name]);
            known[name] = cached;
        }
        // What stands there is whole.
        for (const auto& file : fs::exists(killed.folder + "/out")
                                    ? files_below(killed.folder + "/out")
                                    : std::vector<fs::path>())
            if (file.extension() == ".vdb" && !file.filename().string().starts_with('.'))
                CHECK_NOTHROW(read_vdb_header(file.string()));
    }
    killed.run();
    CHECK(results(killed.folder) == results(calm.folder));
    for (const auto& file : files_below(killed.folder))
        CHECK(file.filename().string().find(".part") == std::string::npos);
    CHECK(killed.run() == Ran{});
}

TEST_CASE("the parts of a run, killed at a hundred moments and begun again, give the same files",
          "[nightly][long]") {
    Shot whole, parts;
    whole.run();
    const std::vector<std::string> steps{"--to seams.energy -f 41-42", "--to seams.energy -f 43-44",
                                         "--only seams", "--from seams -f 41-42",
                                         "--from seams -f 43-44"};
    std::mt19937 random(11);
    std::uniform_real_distribution moment(0.005, 0.15);
    for (std::size_t kills = 0; kills < 100; ++kills) {
        // The earlier steps come first, as on a farm, each killed some times.
        const auto& step = steps[kills * steps.size() / 100];
        call_shell(fmt::format(
            "{} & process=$!; sleep {:.3f}; kill -9 $process 2>/dev/null; wait $process",
            parts.command(step), moment(random)));
        if ((kills + 1) % (100 / steps.size()) == 0) parts.run(step);
    }
    CHECK(parts.run() == Ran{});
    CHECK(results(parts.folder) == results(whole.folder));
    for (const auto& file : files_below(parts.folder))
        CHECK(file.filename().string().find(".part") == std::string::npos);
}

TEST_CASE("parts of a run in processes of their own, and several at once, add up to one run",
          "[nightly][long]") {
    Shot whole, parts;
    whole.run();
    CHECK(parts.run("--to seams.energy -f 41-42") == Ran{{"edges", 4},
                                                         {"energy", 2},
                                                         {"rig", 1},
                                                         {"ring", 1},
                                                         {"seams", 2},
                                                         {"sharp", 2},
                                                         {"sim", 4}});
    const auto rest = parts.run("--to seams.energy -f 43-44");
    CHECK(rest == Ran{{"energy", 2}, {"seams", 2}, {"sharp", 2}, {"sim", 2}});
    CHECK(parts.run("--only seams") == Ran{{"seams", 4}});
    const auto chunk = [&](const char* frames) {
        return parts.command(fmt::format("--only out -f {} & ", frames));
    };
    const auto together = chunk("41-43") + chunk("42-44") + chunk("41-44") + chunk("43") + "wait";
    CHECK(call_shell(together).code == 0);
    CHECK(parts.run("--from seams") == Ran{{"carved", 3}, {"kept", 1}, {"sheet", 3}, {"sim", 3}});
    CHECK(results(parts.folder) == results(whole.folder));
    const auto all_at_once = Shot();
    std::string four;
    for (int n = 0; n < 4; ++n) four += all_at_once.command("") + " & ";
    CHECK(call_shell(four + "wait").err == "");
    CHECK(results(all_at_once.folder) == results(whole.folder));
}

TEST_CASE("damage anywhere in the work folder changes no result", "[nightly]") {
    Shot shot;
    shot.run();
    const auto whole = results(shot.folder);
    std::mt19937 random(3);
    for (int round = 0; round < 3; ++round) {
        for (const auto& file : files_below(shot.folder + "/work")) {
            auto bytes = Scratch::read(file);
            if (bytes.empty()) continue;
            const auto at = random() % bytes.size();
            if (round == 1) bytes.resize(at);
            else bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
            std::ofstream(file, std::ios::binary) << bytes;
        }
        fs::remove_all(shot.folder + "/out");
        const auto called = call_shell(shot.command(""));
        INFO(called.err);
        CHECK(called.code == 0);
        CHECK(results(shot.folder) == whole);
    }
}
