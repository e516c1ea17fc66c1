#include "tests/support/program.h"
#include <fmt/format.h>
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <vector>
#include "tests/trust/program_cases.h"

namespace fs = std::filesystem;

namespace {

std::vector<std::string> shipped_pipelines() {
    std::vector<std::string> out;
    for (const auto& entry : fs::recursive_directory_iterator(SOURCE_ROOT "/pipelines"))
        if (entry.path().extension() == ".yaml")
            out.push_back(fs::relative(entry.path(), SOURCE_ROOT).string());
    std::ranges::sort(out);
    return out;
}

std::vector<std::string> files_in(const Scratch& scratch) {
    std::vector<std::string> out;
    for (const auto& entry : fs::recursive_directory_iterator(scratch.path()))
        out.push_back(entry.path().filename().string());
    std::ranges::sort(out);
    return out;
}

/// The same for what else its params say that it writes.
std::string others_into(const Scratch& scratch, const std::string& pipeline) {
    static const std::regex output(R"(\n  (\w+): +\{type: path, +default: out/([^,]+),)");
    std::string out;
    for (std::sregex_iterator each(pipeline.begin(), pipeline.end(), output), end; each != end;
         ++each)
        if (const auto name = each->str(1); name != "out" && name != "seams" && name != "sheet")
            out += "--set " + name + "=" + (scratch / each->str(2)) + " ";
    return out;
}

}  // namespace

TEST_CASE("every shipped pipeline opens with its purpose, is good, and runs", "[long]") {
    for (const auto& pipeline : shipped_pipelines()) {
        INFO(pipeline);
        const auto text = Scratch::read(SOURCE_ROOT "/" + pipeline);
        // A build without OpenVDB AX has no expressions.
        const auto module =
            fs::path(FLUIDCARVE_PROGRAM).parent_path() / "fluidcarve_expressions.so";
        if (text.find("energy.ax") != std::string::npos && !fs::exists(module)) continue;
        const bool shot = fs::path(pipeline).parent_path() == "pipelines/shots";
        CHECK_THAT(text, Catch::StartsWith(std::string("# yaml-language-server: $schema=") +
                                           (shot ? "../" : "") + "schema.json\n# "));
        const auto checked = fluidcarve_program("check " + pipeline);
        CHECK(checked.err == "");
        CHECK(checked.code == 0);
        const Scratch scratch;
        const auto own_params = [&] {
            const auto all =
                into(scratch, text.find("image.write") == std::string::npos ? "out.####.vdb"
                              : text.find("####.png") == std::string::npos  ? "out.png"
                                                                            : "out.####.png") +
                others_into(scratch, text);
            static const std::regex seams(R"(--set seams=\S+)");
            return text.find("\n  seams:") == std::string::npos ? std::regex_replace(all, seams, "")
                                                                : all;
        };
        // Two frames show that it runs; the tests of the scenes run whole ones. A shot is run
        // whole, with what it extends.
        static const std::regex frames_of(R"(\nframes: (\d+)-(\d+)\n)");
        std::smatch stated;
        std::string file = pipeline;
        if (!shot && std::regex_search(text, stated, frames_of))
            file = scratch.write("two_frames.yaml",
                                 std::regex_replace(text, frames_of,
                                                    fmt::format("\nframes: {}-{}\n", stated.str(1),
                                                                std::stoi(stated.str(1)) + 1)));
        // One lit picture is enough.
        const std::string flat =
            pipeline == "pipelines/plume.yaml" || text.find("show: render") == std::string::npos
                ? ""
                : " --set sheet.show=maximum";
        // What goes into two frames.
        const std::string whole = text.find("time.loop") != std::string::npos ? " --set length=2"
                                  : text.find("axis: t") != std::string::npos ? " --set count=1"
                                                                              : "";
        const auto ran = fluidcarve_program(
            "run -q " + file + flat + whole +
            (shot ? " --progress none --set CACHES=" + scratch.path() + " " : own_params()) +
            "--report " + (scratch / "report.json"));
        CHECK(ran.err == "");
        CHECK(ran.code == 0);
        const auto report = nlohmann::json::parse(Scratch::read(scratch / "report.json"));
        const auto frames = report["frames"].size();
        const auto files = files_in(scratch);
        const auto is_result = [&](const std::string& file) {
            return file.starts_with(shot ? "smoke." : "out.");
        };
        CHECK(std::ranges::count_if(files, is_result) == static_cast<long>(frames));
        CHECK(std::ranges::find(files, "sheet.png") != files.end());
        if (shot || text.find("type: seams.write") != std::string::npos)
            CHECK(std::ranges::find(files, "seams.vdb") != files.end());
        for (const auto& energy : report["seams"]
                                      .value("seams", nlohmann::json::object())
                                      .value("energy", nlohmann::json::array()))
            CHECK(energy.get<double>() > 0);
    }
}

TEST_CASE(
    "check tells where each value of a shot comes from: its own file, the one that it extends, the "
    "environment, the command line") {
    const auto plain = fluidcarve_program("check pipelines/shots/sh010.yaml");
    const auto told = call_shell("CACHES=/show/caches " FLUIDCARVE_PROGRAM
                                 " check -v pipelines/shots/sh010.yaml --set empty=0.4");
    CHECK(told.err == "");
    REQUIRE(told.code == 0);
    CHECK(plain.out == "pipelines/shots/sh010.yaml: good; 11 nodes, 6 frames\n");
    CHECK_THAT(told.out,
               Catch::StartsWith(plain.out +
                                 "\nframes = 51-56, from pipelines/shots/sh010.yaml:10\n\nparams:\n"
                                 "  shot = sh010, from pipelines/shots/sh010.yaml:7\n"));
    for (const std::string line : {
             "  empty = 0.4, from --set",
             "  CACHES = /show/caches, from environment variable CACHES",
             "    count = -18, from pipelines/shots/sh010.yaml:8",
             "    protect = jet, from pipelines/shots/sh010.yaml:15",
             "    empty = 0.4, from --set",
             "    missing = error, default",
         })
        CHECK_THAT(told.out, Catch::Contains("\n" + line + "\n"));
    CHECK_THAT(
        told.out,
        Catch::Contains(
            "\n    path = /show/caches/sh010/smoke.####.vdb, from pipelines/shots/smoke.yaml:") &&
            Catch::Contains(" with CACHES, shot\n"));

    // A page shows a part of it.
    const auto page = Scratch::read(SOURCE_ROOT "/pipelines/README.md");
    const auto begin = page.find("      seams:\n        type = ");
    REQUIRE(begin != std::string::npos);
    const auto part = std::regex_replace(page.substr(begin, page.find("\n\n", begin) + 1 - begin),
                                         std::regex("(^|\n)    "), "$1");
    CHECK_THAT(fluidcarve_program("check -v pipelines/shots/sh010.yaml").out,
               Catch::Contains("\n" + part));

    // From its own folder, places are as they are typed there.
    CHECK_THAT(
        call_shell("cd pipelines/shots && " FLUIDCARVE_PROGRAM " check --verbose sh010.yaml").out,
        Catch::Contains("\n    count = -18, from sh010.yaml:8\n") &&
            Catch::Contains("\n  sim = ../../tests/data/plume/plume.####.vdb, from smoke.yaml:"));

    const auto json =
        nlohmann::json::parse(fluidcarve_program("check -v --json pipelines/shots/sh010.yaml").out);
    CHECK(json["params"]["count"] ==
          nlohmann::json{{"value", "-18"}, {"from", "pipelines/shots/sh010.yaml:8"}});
    CHECK(json["nodes"]["seams"]["count"] == json["params"]["count"]);
    CHECK(json["nodes"]["sheet"]["path"]["with"] == nlohmann::json{"CACHES", "shot"});
    CHECK(fluidcarve_program("check --json pipelines/shots/sh010.yaml").out == "[]\n");
    const auto bad =
        fluidcarve_program("check -v --json pipelines/shots/sh010.yaml --set count=many");
    CHECK(bad.code == 2);
    CHECK(nlohmann::json::parse(bad.out)[0]["file"] == "--set");
}

TEST_CASE("the same files whatever the threads and the frames in flight, in one run or in chunks",
          "[long]") {
    const Scratch one;
    const Scratch other;
    REQUIRE(
        fluidcarve_program("run pipelines/plume.yaml --threads 4 --in-flight 6" + into(one)).code ==
        0);
    REQUIRE(fluidcarve_program("run pipelines/plume.yaml --threads 1 --in-flight 1 -f 51-52" +
                               into(other))
                .code == 0);
    REQUIRE(fluidcarve_program("run pipelines/plume.yaml --threads 3 --in-flight 2 -f 53-56" +
                               into(other))
                .code == 0);
    const auto seams = [&](const Scratch& scratch) {
        return Scratch::read(scratch / "seams.vdb").size();
    };
    CHECK(seams(one) == seams(other));
    for (int frame = 51; frame <= 56; ++frame) {
        const auto name = "out.00" + std::to_string(frame) + ".vdb";
        CHECK(same_but_identifier(one, other, name));
    }
}

TEST_CASE("exit codes and channels are the contract's") {
    const Scratch scratch;
    CHECK(fluidcarve_program("").code == 2);
    CHECK(fluidcarve_program("rnu").code == 2);
    CHECK(fluidcarve_program("run").code == 2);
    CHECK(fluidcarve_program("run nowhere.yaml").err ==
          "cannot read nowhere.yaml: it does not exist\n");
    CHECK(fluidcarve_program("run nowhere.yaml").code == 2);
    CHECK(fluidcarve_program("--help").code == 0);
    CHECK_THAT(fluidcarve_program("--help").out, Catch::Contains("run") && Catch::Contains("plan"));

    const auto path =
        scratch.write("p.yaml",
                      "fluidcarve: 1\nframes: 1-3\nnodes:\n  sim: {type: vdb.read, path: "
                      "in.####.vdb}\n  out: {type: vdb.write, source: sim, path: " +
                          (scratch / "out.####.vdb") + "}\n");
    fs::copy_file(TEST_DATA "/plume/plume.0051.vdb", scratch / "in.0002.vdb");
    CHECK(fluidcarve_program("check " + path).code == 0);
    const auto missing = fluidcarve_program("run " + path);
    CHECK(missing.code == 3);
    CHECK(missing.out == "");
    CHECK_THAT(missing.err, Catch::Contains("failed: sim (vdb.read), frame 1: ") &&
                                Catch::Contains("frame 3: "));
    CHECK(fluidcarve_program("run " + path + " --keep-going --progress none").code == 4);
    CHECK(fluidcarve_program("run " + path + " -f 9").err == "-f: 9 is not in the sequence 1-3\n");
    CHECK(fluidcarve_program("run " + path + " --to otu").err ==
          "--to: there is no node 'otu'; did you mean 'out'?\n");
    CHECK(fluidcarve_program("run " + path + " --only otu").err ==
          "--only: there is no node 'otu'; did you mean 'out'?\n");
    CHECK(fluidcarve_program("run " + path + " --from otu").err ==
          "--from: there is no node 'otu'; did you mean 'out'?\n");
    CHECK(fluidcarve_program("run " + path + " --memory lots").err ==
          "--memory must be a size such as 8G, not 'lots'\n");
    CHECK(fluidcarve_program("run " + path + " --memory 100000000T").err ==
          "--memory must be a size such as 8G, not '100000000T'\n");

    scratch.write("bad.yaml", "fluidcarve: 1\nnodes:\n  sim: {type: vdb.raed, path: a}\n");
    const auto problems =
        nlohmann::json::parse(fluidcarve_program("check --json " + (scratch / "bad.yaml")).out);
    REQUIRE(problems.size() == 1);
    CHECK(problems[0]["line"] == 3);
    CHECK(problems[0]["column"] == 15);
    CHECK(problems[0]["message"] == "there is no node type 'vdb.raed'; did you mean 'vdb.read'?");
}

TEST_CASE("Ctrl-C stops a run within a second and leaves no half file") {
    const Scratch scratch;
    std::string frames = "1-4000";
    const auto path =
        scratch.write("p.yaml", "fluidcarve: 1\nframes: " + frames +
                                    "\nnodes:\n  sim: {type: vdb.read, path: " TEST_DATA
                                    "/plume/plume.0051.vdb}\n"
                                    "  all: {type: vdb.read, path: \"" +
                                    (scratch / "in.####.vdb") + "\", missing: hold}\n" +
                                    "  out: {type: vdb.write, source: all, path: \"" +
                                    (scratch / "out.####.vdb") + "\"}\n");
    fs::copy_file(TEST_DATA "/plume/plume.0051.vdb", scratch / "in.0001.vdb");
    const auto ran = call_shell(
        "(" FLUIDCARVE_PROGRAM " run " + path + " --to out --progress none & pid=$!; until [ -e " +
        (scratch / "out.0003.vdb") +
        " ]; do sleep 0.02; done; kill -INT $pid; begin=$(date +%s%N); wait $pid; code=$?; " +
        "echo $(( ($(date +%s%N) - begin) / 1000000 )); exit $code)");
    CHECK(ran.code == 130);
    CHECK_THAT(ran.err, Catch::EndsWith("interrupted; run it again to continue\n"));
    CHECK(std::stoi(ran.out) < 1000);
    const auto files = files_in(scratch);
    CHECK(files.size() > 2);
    CHECK(files.size() < 4000);
    for (const auto& file : files) CHECK_THAT(file, !Catch::Contains(".part"));
}

TEST_CASE("the README's pipeline is good and runs, and its mistake is told as the README says",
          "[long]") {
    const auto readme = Scratch::read(SOURCE_ROOT "/README.md");
    const std::string fence = "```yaml\n";
    const auto begin = readme.find(fence) + fence.size();
    const auto text = readme.substr(begin, readme.find("```", begin) - begin);
    const Scratch scratch;
    const auto path = scratch.write("readme.yaml", text);
    const auto ran =
        fluidcarve_program("run -q " + path + " --set out.path=" + (scratch / "out.####.vdb"));
    CHECK(ran.err == "");
    CHECK(ran.code == 0);
    CHECK(fs::exists(scratch / "out.0056.vdb"));

    scratch.write("shot.yaml",
                  std::regex_replace(text, std::regex("energy: energy,"), "energy: sim.densty,"));
    const auto told =
        call_shell("cd " + scratch.path() + " && " FLUIDCARVE_PROGRAM " check shot.yaml").err;
    REQUIRE_THAT(told, Catch::StartsWith("shot.yaml:"));
    const auto first = told.substr(0, told.find("^\n") + 1);
    CHECK_THAT(
        readme,
        Catch::Contains("\n    " + std::regex_replace(first, std::regex("\n"), "\n    ") + "\n"));
}

TEST_CASE("the shot that a page shows is the one that ships") {
    const auto shot = Scratch::read(SOURCE_ROOT "/pipelines/shots/sh010.yaml");
    CHECK_THAT(Scratch::read(SOURCE_ROOT "/pipelines/README.md"),
               Catch::Contains("```yaml\n" + shot.substr(shot.find("fluidcarve: 1")) + "```\n"));
}

TEST_CASE("pages name verbs, options and node types that there are", "[long]") {
    const auto all = [](const std::string& text, const std::string& pattern, auto&& tell) {
        const std::regex expression(pattern);
        for (std::sregex_iterator at(text.begin(), text.end(), expression), end; at != end; ++at)
            tell(*at);
    };
    const auto types = fluidcarve_program("nodes").out;
    const auto help = [](const std::string& verb) {
        const auto called = fluidcarve_program(verb + " --help");
        CHECK(called.code == 0);
        return called.out + " --help ";
    };
    int commands = 0, options = 0, nodes = 0;
    for (const std::string page : {"README.md", "nodes/README.md", "pipelines/README.md",
                                   "python/README.md", "runtime/README.md"}) {
        const auto text =
            std::regex_replace(Scratch::read(SOURCE_ROOT "/" + page), std::regex(R"(\\\n *)"), "");
        all(text, R"([/`]fluidcarve ([a-z-]+)([^`#\n]*))", [&](const std::smatch& command) {
            INFO(page << ": " << command.str());
            const auto known = help(command[1]);
            all(command[2], R"( (--?[a-z][a-z-]*))", [&](const std::smatch& option) {
                INFO(option.str());
                CHECK(std::regex_search(known, std::regex("[ ,]" + option.str(1) + "[ ,]")));
            });
            ++commands;
        });
        // The tables of options, and that of verbs.
        const auto of_run =
            page == "runtime/README.md" ? help("run") + help("diff") + help("view") : "";
        all(text, R"(\n\| `(--?[a-z][a-z-]*))", [&](const std::smatch& option) {
            INFO(page << ": " << option.str());
            CHECK(std::regex_search(of_run, std::regex("[ ,]" + option.str(1) + "[ ,]")));
            ++options;
        });
        if (page == "runtime/README.md")
            all(text, R"(\n\| `([a-z][a-z-]*))", [&](const std::smatch& verb) { help(verb[1]); });
        all(text, R"((`|type: )([a-z]+\.)([a-z_]+)[`,}\n])", [&](const std::smatch& type) {
            // Of a family that there is: not `sim.density`, nor a file, nor the example of a page.
            if (types.find("\n  " + type.str(2)) == std::string::npos || type.str(3) == "yaml")
                return;
            INFO(page << ": " << type.str());
            CHECK_THAT(types, Catch::Contains("\n  " + type.str(2) + type.str(3) + " "));
            ++nodes;
        });
    }
    CHECK(commands > 15);
    CHECK(options > 15);
    CHECK(nodes > 60);
}

TEST_CASE("the generated reference and schema are current") {
    CHECK(Scratch::read(SOURCE_ROOT "/pipelines/NODES.md") ==
          fluidcarve_program("nodes --markdown").out);
    CHECK(Scratch::read(SOURCE_ROOT "/pipelines/schema.json") == fluidcarve_program("schema").out);
}

TEST_CASE("the schema accepts every shipped pipeline, as an independent validator reads it") {
    std::string list;
    for (const auto& pipeline : shipped_pipelines()) list += " " + pipeline;
    const auto ran = call_shell(R"(/usr/bin/python3 -c '
import json, sys, yaml, jsonschema
schema = json.load(open("pipelines/schema.json"))
jsonschema.Draft7Validator.check_schema(schema)
for path in sys.argv[1:]:
    jsonschema.validate(yaml.safe_load(open(path)), schema)
' )" + list);
    CHECK(ran.err == "");
    CHECK(ran.code == 0);
}
