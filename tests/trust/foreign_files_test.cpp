#include "tests/support/program.h"

#include <catch2/catch.hpp>

#include <nlohmann/json.hpp>

#include <sys/stat.h>
#include <unistd.h>
#include <filesystem>
#include <string>
#include <vector>

namespace fs = std::filesystem;

namespace {

/// A folder with a pipeline that copies a volume, and a work folder in it.
struct Shot {
    explicit Shot(const std::string& name = "p.yaml") : pipeline(scratch / name) {
        fs::copy_file(TEST_DATA "/vdb/cortex_points.vdb", scratch / "in.0001.vdb");
        scratch.write(name,
                      "fluidcarve: 1\nframes: 1\nnodes:\n  sim: {type: vdb.read, path: "
                      "in.####.vdb}\n  out: {type: vdb.write, source: sim, path: \"" +
                          (scratch / "out.####.vdb") + "\"}\n");
    }
    std::string out() const { return scratch / "out.0001.vdb"; }
    /// @param more  arguments behind those of the verb
    Called call(const std::string& verb, const std::string& more = {}) const {
        const bool of_folder = verb.starts_with("status") || verb.starts_with("clean");
        return call_shell("FLUIDCARVE_WORK=" + (scratch / "work") +
                          " timeout -s KILL 20 " FLUIDCARVE_PROGRAM " " + verb +
                          (of_folder ? " " : " '" + pipeline + "' ") + more);
    }
    Scratch scratch;
    std::string pipeline;
};

constexpr int killed = 137;

std::string only_file(const std::string& folder) {
    for (const auto& each : fs::directory_iterator(folder)) return each.path().string();
    return {};
}

bool is_json(const std::string& text) {
    return !nlohmann::json::parse(text, nullptr, false).is_discarded();
}

}  // namespace

TEST_CASE("a pipe in the place of a file of ours is not waited for, and stays", "[nightly]") {
    const Shot shot;
    for (const std::string place :
         {"CACHEDIR.TAG", "history/p.json", "runs", "cache", "jobs/p/job.json",
          "jobs/p/tasks/out.json", "jobs/p/logs/out.log"}) {
        INFO(place);
        fs::remove_all(shot.scratch / "work");
        REQUIRE(shot.call("run -q").code == 0);
        auto pipe = shot.scratch / "work/" + place;
        if (fs::is_directory(pipe)) pipe = only_file(pipe);
        fs::remove(pipe);
        fs::create_directories(fs::path(pipe).parent_path());
        REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
        if (place.starts_with("jobs/p/") && !place.ends_with("job.json"))
            shot.scratch.write(
                "work/jobs/p/job.json",
                R"({"pipeline": "p.yaml", "engine": "local", "steps": [], "name": "p", "again": ""})");
        for (const std::string verb :
             {"run -q", "plan", "status", "status --json", "farm local", "clean"}) {
            INFO(verb);
            CHECK(shot.call(verb).code != killed);
            if (verb != "clean") CHECK(fs::is_fifo(pipe));
        }
        CHECK(fs::is_fifo(pipe));
    }
}

TEST_CASE("a pipe is no plugin") {
    const Scratch scratch;
    const auto pipe = scratch / "x.so";
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    const auto called =
        call_shell("timeout -s KILL 60 " FLUIDCARVE_PROGRAM " nodes --plugin " + pipe);
    CHECK(called.err == pipe + " is a pipe or a device; a plugin is read from a regular file\n");
    CHECK(called.code == 2);
}

TEST_CASE("an output that is a link is refused, and so is what it leads to left alone") {
    const Shot shot;
    const auto other = shot.scratch.write("other.vdb", "of others");
    fs::create_symlink(other, shot.out());
    const auto called = shot.call("run -q");
    CHECK(called.err ==
          "failed: out (vdb.write), frame 1: cannot write " + shot.out() + ": it is a link to " +
              other + ", which a file must not replace; remove the link, or name another path\n");
    CHECK(called.code == 1);
    CHECK(fs::is_symlink(shot.out()));
    CHECK(Scratch::read(other) == "of others");
}

TEST_CASE(
    "the lock of a manifest is made through no link, in no place outside of --confine, and over no "
    "file of others") {
    const Shot shot;
    const auto manifest = shot.scratch / "inside/m", lock = manifest + ".lock",
               outside = shot.scratch / "outside";
    fs::create_directory(shot.scratch / "inside");
    const auto run = [&] { return shot.call("run -q", "--no-cache --manifest " + manifest); };

    fs::create_symlink(outside, lock);
    auto called = run();
    CHECK(called.err == "failed: manifest: cannot lock " + lock + ": it is a link; remove it\n");
    CHECK(called.code == 1);
    CHECK(!fs::exists(outside));
    CHECK(fs::is_symlink(lock));

    fs::remove(lock);
    shot.scratch.write("inside/m.lock", "of others");
    called = run();
    CHECK(called.err == "failed: manifest: cannot lock " + lock +
                            ": it is no lock of fluidcarve; remove or rename it\n");
    CHECK(Scratch::read(lock) == "of others");

    fs::remove(lock);
    CHECK(run().code == 0);
    CHECK(fs::exists(manifest));
    CHECK(!fs::exists(lock));
}

TEST_CASE("JSON is valid whatever bytes a name has") {
    const Shot shot("p\xff\xfe.yaml");
    for (const std::string verb :
         {"plan --json", "run --progress none --report /dev/stdout", "status --json",
          "check --json", "check --json -v", "farm local --dry-run --json"}) {
        INFO(verb);
        const auto called = shot.call(verb);
        CHECK(called.code == 0);
        CHECK(is_json(called.out));
    }
    for (const std::string verb : {"farm local -q", "status --json"}) {
        INFO(verb);
        const auto called = shot.call(verb);
        CHECK(called.code == 0);
        if (verb == "status --json") CHECK(is_json(called.out));
    }
    fs::rename(shot.scratch / "in.0001.vdb", shot.scratch / "in\xff.0001.vdb");
    for (const auto& verb : {std::string("inspect --json"), "diff --json '" + shot.out() + "'"}) {
        INFO(verb);
        CHECK(is_json(call_shell(FLUIDCARVE_PROGRAM " " + verb + " '" +
                                 (shot.scratch / "in\xff.0001.vdb") + "'")
                          .out));
    }
}

TEST_CASE(
    "a result that --to asks for and that can't be kept fails the run, as nothing else is there") {
    const Scratch scratch;
    fs::copy_file(TEST_DATA "/vdb/gaffer_arnold_sphere.vdb", scratch / "in.0001.vdb");
    const auto pipeline = scratch.write("p.yaml",
                                        "fluidcarve: 1\nframes: 1\nnodes:\n  sim: {type: vdb.read, "
                                        "path: in.####.vdb, grids: {density: float}}\n"
                                        "  energy: {type: energy.gradient, field: sim.density}\n"
                                        "  out: {type: vdb.write, source: energy, path: \"" +
                                            (scratch / "out.####.vdb") + "\"}\n");
    fs::create_directories(scratch / "work");
    scratch.write("work/cache", "a file in the place of the folder");
    const auto run = [&](const std::string& options) {
        return call_shell("FLUIDCARVE_WORK=" + (scratch / "work") +
                          " " FLUIDCARVE_PROGRAM " run --progress none " + pipeline + options);
    };
    const auto asked = run(" --to energy");
    CHECK_THAT(asked.err, Catch::StartsWith("failed: energy (energy.gradient): its results could "
                                            "not be kept for other runs: cannot write "));
    CHECK(asked.code == 1);
    const auto written = run("");
    CHECK_THAT(written.err,
               Catch::Contains("warning: results could not be kept for other runs: cannot write "));
    CHECK(written.code == 0);
    CHECK(fs::exists(scratch / "out.0001.vdb"));
    CHECK(Scratch::read(scratch / "work/cache") == "a file in the place of the folder");
}

TEST_CASE("a work folder that can't be read is told as such, and not taken for an empty one") {
    // Root may read all.
    const std::string nobody =
        geteuid() == 0 ? "setpriv --reuid=54321 --regid=54321 --clear-groups " : "";
    if (call_shell(nobody + FLUIDCARVE_PROGRAM " --version").code != 0) {
        WARN("skipped: the build is for its owner alone");
        return;
    }
    const Scratch scratch;
    fs::copy_file(TEST_DATA "/vdb/gaffer_arnold_sphere.vdb", scratch / "in.0001.vdb");
    scratch.write("p.yaml",
                  "fluidcarve: 1\nframes: 1\nnodes:\n  sim: {type: vdb.read, path: in.####.vdb, "
                  "grids: {density: float}}\n"
                  "  energy: {type: energy.gradient, field: sim.density}\n  box: {type: "
                  "lattice.box, fit: sim.density}\n"
                  "  seams: {type: seam.greedy, energy: energy, lattice: box, axis: u, count: -2}\n"
                  "  carved: {type: remap.grids, source: sim, lattice: box, seams: seams}\n"
                  "  out: {type: vdb.write, source: carved, path: out.####.vdb}\n");
    fs::permissions(scratch.path(), fs::perms::all);
    const auto call = [&](const std::string& verb) {
        return call_shell("cd " + scratch.path() + "; export FLUIDCARVE_WORK=work; " + nobody +
                          FLUIDCARVE_PROGRAM " " + verb);
    };
    REQUIRE(call("run p.yaml -q").code == 0);
    for (const std::string folder : {"work", "work/cache"}) {
        INFO(folder);
        fs::permissions(scratch / folder, fs::perms::none);
        const auto viewed = call("view p.yaml -o view.html --progress none");
        CHECK(viewed.code == 3);
        CHECK_THAT(
            viewed.err,
            Catch::StartsWith(
                "failed: nothing tells whether the seams are found: cannot read work/cache/") &&
                Catch::EndsWith(": Permission denied; make it readable, or name another work "
                                "folder with --work\n"));
        CHECK(!fs::exists(scratch / "view.html"));
        const auto only = call("run p.yaml --only carved --progress none");
        CHECK(only.code == 3);
        CHECK_THAT(only.err,
                   Catch::Contains("seams (seam.greedy): nothing tells whether its results are in "
                                   "the work folder: cannot read work/cache/"));
        CHECK_THAT(
            call("plan p.yaml").err,
            Catch::StartsWith(
                "warning: results of earlier runs could not be used: cannot read work/cache/"));
        for (const std::string verb : {"status", "status --json", "clean"}) {
            INFO(verb);
            const auto called = call(verb);
            CHECK(called.err == "failed: cannot look through " + folder + ": Permission denied\n");
            CHECK(called.code == 3);
        }
        fs::permissions(scratch / folder, fs::perms::owner_all);
    }
    CHECK(call("view p.yaml -o view.html -q").code == 0);
}
