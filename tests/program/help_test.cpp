#include "tests/support/program.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <sstream>
#include <utility>
#include <vector>

namespace {

/// The verbs, as `--help` lists them.
std::vector<std::string> verbs() {
    std::istringstream help(fluidcarve_program("--help").out);
    std::vector<std::string> out;
    bool listed = false;
    for (std::string line; std::getline(help, line);) {
        if (listed && line.starts_with("  ") && line.size() > 2 && line[2] != ' ')
            out.push_back(line.substr(2, line.find(' ', 2) - 2));
        listed = listed || line == "Subcommands:" || line == "SUBCOMMANDS:";
    }
    return out;
}

}  // namespace

TEST_CASE("every verb explains itself, with an example, in its help and in the manual page",
          "[long]") {
    const auto all = verbs();
    REQUIRE(all.size() >= 11);
    const auto man = fluidcarve_program("man");
    CHECK(man.code == 0);
    CHECK(man.out.starts_with(".TH FLUIDCARVE 1"));
    for (const auto& verb : all) {
        INFO(verb);
        const auto help = fluidcarve_program(verb + " --help");
        CHECK(help.code == 0);
        CHECK_THAT(help.out,
                   Catch::Contains("Examples:\n") && Catch::Contains("fluidcarve " + verb + " "));
        CHECK_THAT(man.out,
                   Catch::Contains(".SS " + (verb == "new-node" ? "new\\-node" : verb) + "\n"));
    }
    for (const auto* const text :
         {"\\-f, \\-\\-frames FRAMES", "FLUIDCARVE_WORK", "(dot svg)", "130 interrupted"})
        CHECK_THAT(man.out, Catch::Contains(text));
}

TEST_CASE("a verb that is none is answered with the nearest one") {
    const auto called = fluidcarve_program("rnu pipelines/plume.yaml");
    CHECK(called.code == 2);
    CHECK(called.err == "there is no verb 'rnu'; did you mean 'run'?\n");
    const auto nothing = fluidcarve_program("");
    CHECK(nothing.code == 2);
    CHECK_THAT(nothing.err, Catch::StartsWith("fluidcarve needs a verb: run, check, plan,"));
    CHECK_THAT(fluidcarve_program("shrink").err,
               Catch::StartsWith("there is no verb 'shrink'; known: run, check, "));
}

TEST_CASE("nodes lists a family, and answers a name that is none with near ones") {
    const auto mask = fluidcarve_program("nodes mask");
    CHECK(mask.code == 0);
    CHECK_THAT(mask.out, Catch::StartsWith("mask\n  mask.below_surface  ") &&
                             Catch::Contains("\n  mask.threshold      ") &&
                             !Catch::Contains("seam."));
    CHECK(fluidcarve_program("nodes mask --markdown")
              .out.starts_with("## mask\n\n### mask.below_surface\n"));
    CHECK(
        fluidcarve_program("nodes mask --json")
            .out.starts_with("{\n  \"nodes\": [\n    {\n      \"name\": \"mask.below_surface\","));
    CHECK(fluidcarve_program("nodes energi").err ==
          "there is no node type or family 'energi'; did you mean 'energy'?\n");
    CHECK_THAT(fluidcarve_program("nodes gradient").err,
               Catch::StartsWith("there is no node type or family 'gradient'; did you mean "
                                 "'energy.gradient' or 'field.gradient'"));
    CHECK(fluidcarve_program("nodes mask.spere").err ==
          "there is no node type 'mask.spere'; did you mean 'mask.sphere'?\n");
    CHECK(fluidcarve_program("nodes mask.spere").code == 2);
}

TEST_CASE("bash completes verbs, options, choices and node types") {
    const auto complete = [](const std::string& words, int at) {
        return call_shell("PATH=$(dirname " FLUIDCARVE_PROGRAM
                          "):$PATH bash -c 'source <(fluidcarve completion bash); COMP_WORDS=(" +
                          words + "); COMP_CWORD=" + std::to_string(at) +
                          "; _fluidcarve; echo ${COMPREPLY[@]}'")
            .out;
    };
    CHECK(complete("fluidcarve st", 1) == "status\n");
    CHECK(complete("fluidcarve run --to", 2) == "--to\n");
    CHECK(complete("fluidcarve graph --format s", 3) == "svg\n");
    CHECK(complete("fluidcarve nodes seam.p", 2) == "seam.pyramid seam.python\n");
    CHECK(complete("fluidcarve nodes rig", 2) ==
          "rig rig.advect rig.circle rig.curve rig.points rig.python rig.transform\n");
    CHECK(complete("fluidcarve diff --pi", 2) == "--picture\n");
    CHECK(complete("fluidcarve run pipelines/plume_w", 2) == "pipelines/plume_wide.yaml\n");
}

TEST_CASE("zsh completes the same, as a sourced script and as a function that is loaded") {
    if (call_shell("command -v zsh").code != 0) {
        WARN("zsh is not here: its completion was not tried");
        return;
    }
    const auto complete = [](const std::string& words, int at, const std::string& load) {
        return call_shell("PATH=$(dirname " FLUIDCARVE_PROGRAM
                          "):$PATH zsh -f -c 'compdef() { :; }; compadd() { shift; print -r -- $@; "
                          "}; _files() { print files; }; " +
                          load + " words=(" + words + "); CURRENT=" + std::to_string(at + 1) +
                          "; _fluidcarve'")
            .out;
    };
    const Scratch scratch;
    scratch.write("_fluidcarve", fluidcarve_program("completion zsh").out);
    for (const std::string& load : {std::string("source <(fluidcarve completion zsh);"),
                                    "fpath=(" + scratch.path() + "); autoload -Uz _fluidcarve;"}) {
        CHECK(complete("fluidcarve graph --format s", 3, load) == "dot svg\n");
        CHECK_THAT(complete("fluidcarve st", 1, load), Catch::Contains(" status "));
        CHECK_THAT(complete("fluidcarve nodes seam", 2, load), Catch::Contains(" seam.pyramid "));
        CHECK(complete("fluidcarve run pipe", 2, load) == "files\n");
    }
}

TEST_CASE("fish completes verbs, options, choices and node types") {
    if (call_shell("command -v fish").code != 0) {
        WARN("fish is not here: its completion was not tried");
        return;
    }
    const auto complete = [](const std::string& line) {
        return call_shell("PATH=$(dirname " FLUIDCARVE_PROGRAM
                          "):$PATH HOME=/nonexistent fish -N -c 'fluidcarve completion fish | "
                          "source; complete -C \"" +
                          line + "\"'")
            .out;
    };
    CHECK_THAT(complete("fluidcarve st"), Catch::StartsWith("status\tShow how far"));
    CHECK(complete("fluidcarve graph --format s") == "svg\tFormat of the picture\n");
    CHECK(complete("fluidcarve nodes seam.py") == "seam.pyramid\nseam.python\n");
    CHECK_THAT(complete("fluidcarve run --manif"), Catch::StartsWith("--manifest\t"));
    CHECK(complete("fluidcarve run pipelines/plume_w") == "pipelines/plume_wide.yaml\n");
}

TEST_CASE("the environment stands for options, and the command line overrules it") {
    const Scratch scratch;
    const auto status = [&](const std::string& arguments) {
        return call_shell("FLUIDCARVE_WORK=" + (scratch / "a") + " " FLUIDCARVE_PROGRAM " status" +
                          arguments)
            .out;
    };
    CHECK(status("") == "no runs are recorded in '" + (scratch / "a") + "'\n");
    CHECK(status(" --work " + (scratch / "b")) ==
          "no runs are recorded in '" + (scratch / "b") + "'\n");
}

TEST_CASE("a work folder tells of its runs, and is cleaned") {
    const Scratch scratch;
    const auto work = " --work " + (scratch / "work");
    const auto run = "run -q pipelines/plume.yaml --set out=" + (scratch / "out.####.vdb") +
                     " --set seams=" + (scratch / "seams.vdb") + " --to energy" + work;
    REQUIRE(fluidcarve_program(run).code == 0);
    const auto status = fluidcarve_program("status" + work);
    CHECK_THAT(status.out, Catch::StartsWith("pipelines/plume.yaml: done, "));
    CHECK_THAT(status.out,
               Catch::Contains("node    type             frames  cached  done  why it runs\n"));
    CHECK_THAT(status.out,
               Catch::Contains("edges   energy.gradient       6       0     6  never run\n"));
    CHECK_THAT(fluidcarve_program("clean --dry-run" + work).out,
               Catch::StartsWith((scratch / "work") + ": would remove "));
    CHECK(fluidcarve_program("clean --older 7d" + work).out.find(": nothing to clean; ") !=
          std::string::npos);
    CHECK(fluidcarve_program("clean --older soon" + work).err ==
          "--older: 'soon' is no age such as 7d, 12h, 30m or 2w\n");
    CHECK_THAT(fluidcarve_program("clean" + work).out,
               Catch::StartsWith((scratch / "work") + ": removed "));
    CHECK_FALSE(std::filesystem::exists(scratch / "work"));
    CHECK(fluidcarve_program("clean" + work).out == (scratch / "work") + ": nothing to clean\n");
}

TEST_CASE("a folder that is no work folder loses nothing, neither to clean nor to a small cache") {
    const Scratch scratch;
    const auto shot = scratch / "shot";
    std::filesystem::create_directories(shot + "/cache/sim");
    scratch.write("shot/cache/sim/smoke.0001.vdb", "smoke");
    const auto run = "run -q pipelines/plume.yaml --set out=" + (scratch / "out.####.vdb") +
                     " --set seams=" + (scratch / "seams.vdb") + " --to energy --work " + shot;
    for (const auto& command : {run + " --cache-size 1M", "clean --work " + shot}) {
        const auto refused = fluidcarve_program(command + " 2>&1");
        CHECK(refused.code == 2);
        CHECK_THAT(refused.out,
                   Catch::Contains("'" + shot + "' is not a work folder of fluidcarve"));
    }
    REQUIRE(fluidcarve_program(run).code == 0);
    CHECK(Scratch::read(shot + "/cache/sim/smoke.0001.vdb") == "smoke");
}

TEST_CASE("nothing is written through a link in a work folder") {
    const Scratch scratch;
    namespace fs = std::filesystem;
    const auto shot = scratch / "shot", other = scratch / "other";
    fs::create_directories(shot);
    fs::create_directories(other);
    fs::create_directory_symlink(other, shot + "/cache");
    const auto run = "run -q pipelines/plume.yaml --to energy --work " + shot;
    const auto refused = fluidcarve_program(run);
    CHECK(refused.code == 2);
    CHECK_THAT(refused.err,
               Catch::StartsWith("--work: '" + shot +
                                 "/cache' is a link: what it leads to may belong to others"));
    CHECK(fs::is_empty(other));
    CHECK(fluidcarve_program(run + " --no-cache").code == 0);
    CHECK(fs::is_empty(other));
}

TEST_CASE("colours are for terminals that want them") {
    const Scratch scratch;
    const auto run =
        "run " +
        scratch.write("p.yaml", "fluidcarve: 1\nnodes:\n  sim: {type: vdb.read, path: none.vdb}\n");
    const auto in_terminal = [&](const std::string& before) {
        return call_shell(before + " script -qec '" FLUIDCARVE_PROGRAM " " + run + "' /dev/null")
            .out;
    };
    const std::string red = "\033[1;31mfailed:\033[0m";
    CHECK_THAT(in_terminal("NO_COLOR="), Catch::Contains(red));
    CHECK_THAT(in_terminal("NO_COLOR=1"), !Catch::Contains("\033[1;31m"));
    CHECK_THAT(fluidcarve_program(run).err, Catch::StartsWith("failed: sim"));
}

TEST_CASE(
    "a template is checked without its values, another type says which fields to drop, and a "
    "missing file where it was looked for") {
    const Scratch scratch;
    scratch.write("base.yaml", R"(fluidcarve: 1
params:
  sim: {type: path, doc: The input.}
nodes:
  sim: {type: vdb.read, path: "${sim}", grids: {density: float}}
  edges: {type: energy.gradient, field: sim.density}
  box: {type: lattice.box, fit: sim.density}
  seams: {type: seam.pyramid, energy: edges, lattice: box, count: -4, quality: best}
)");
    const auto in = [&](const std::string& command) {
        return call_shell("cd " + scratch.path() + " && " FLUIDCARVE_PROGRAM " " + command);
    };
    CHECK_THAT(
        in("check base.yaml").err,
        Catch::StartsWith(
            "base.yaml:3:3: param 'sim' has no value; give it a default or --set sim=...\n"));
    CHECK(in("check base.yaml --template").out == "base.yaml: good; 4 nodes, 1 frame\n");
    scratch.write("shot.yaml",
                  "extends: base.yaml\nparams:\n  sim: {type: path, default: in.vdb}\nnodes:\n  "
                  "seams: {type: seam.greedy}\n");
    CHECK_THAT(in("check shot.yaml").err,
               Catch::StartsWith("shot.yaml:5:17: seam.greedy has no 'quality' (base.yaml:8), "
                                 "which the extended file states for another "
                                 "type: drop it here with `quality: null`\n"));
    scratch.write("shot.yaml",
                  "extends: base.yaml\nparams:\n  sim: {type: path, default: in.vdb}\nnodes:\n  "
                  "seams: {type: seam.greedy, quality: null}\n");
    CHECK(in("check shot.yaml").code == 0);
    std::filesystem::create_directories(scratch / "elsewhere");
    CHECK_THAT(
        call_shell("cd " + (scratch / "elsewhere") + " && " FLUIDCARVE_PROGRAM " run ../shot.yaml")
            .err,
        Catch::Contains("../in.vdb does not exist, nor does in.vdb in the current folder\n"));
}

TEST_CASE(
    "for programs all that a run tells is an event: progress, warnings, results, failures, also "
    "where nothing runs") {
    const Scratch scratch;
    const auto events_of = [](const std::string& text) {
        std::vector<std::pair<std::string, std::string>> out;
        std::istringstream lines(text);
        for (std::string line; std::getline(lines, line);) {
            const auto event = nlohmann::json::parse(line);
            if (event["event"] != "progress") out.emplace_back(event["event"], event["text"]);
        }
        return out;
    };
    const auto carve =
        "carve tests/data/plume/plume.0051.vdb --progress json -o " + (scratch / "o.vdb");
    const auto done = events_of(fluidcarve_program(carve + " -4").err);
    REQUIRE(done.size() == 4);
    CHECK(done.front().first == "result");
    CHECK_THAT(done.front().second, Catch::StartsWith("carved: density "));
    CHECK(done.back().first == "done");
    CHECK_THAT(done.back().second, Catch::StartsWith("1 frame in "));
    const auto wrong = fluidcarve_program(carve + " -4.5");
    CHECK(wrong.code == 2);
    CHECK(events_of(wrong.err).front().first == "failure");
    const auto warned = events_of(fluidcarve_program(carve + " -30 --protect density=0.05").err);
    CHECK(warned.front().first == "warning");
}
