#include "tests/support/program.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <set>

namespace fs = std::filesystem;

namespace {

/// A pipeline `p.yaml` that copies a file to `out/o.####.vdb`, so many frames.
class Copies {
public:
    explicit Copies(int frames) {
        fs::copy_file(TEST_DATA "/plume/plume.0051.vdb", scratch / "in.0001.vdb");
        scratch.write("p.yaml",
                      "fluidcarve: 1\nframes: 1-" + std::to_string(frames) +
                          "\nnodes:\n  sim: {type: vdb.read, path: in.####.vdb, missing: hold}\n" +
                          "  out: {type: vdb.write, source: sim, path: \"" +
                          (scratch / "out/o.####.vdb") + "\"}\n");
    }
    std::string run() const { return FLUIDCARVE_PROGRAM " run " + (scratch / "p.yaml") + " "; }
    std::set<std::string> files() const {
        std::set<std::string> out;
        for (const auto& entry : fs::directory_iterator(scratch / "out"))
            out.insert(entry.path().filename().string());
        return out;
    }

    Scratch scratch;
};

}  // namespace

TEST_CASE("a reader of messages that leaves does not end a run") {
    const Copies copies(3);
    const auto ran = call_shell(copies.run() + "-v 2>&1 | head -1");
    CHECK_THAT(ran.out, Catch::Contains("p.yaml: 2 nodes"));
    CHECK(copies.files() == std::set<std::string>{"o.0001.vdb", "o.0002.vdb", "o.0003.vdb"});
}

TEST_CASE("a file beyond the limit of sizes is an error that names it, and leaves no part") {
    const Copies copies(1);
    const auto ran = call_shell("ulimit -f 8; " + copies.run() + "--no-cache --progress none");
    CHECK(ran.code == 1);
    CHECK(ran.err == "failed: out (vdb.write), frame 1: cannot write " +
                         (copies.scratch / "out/o.0001.vdb") +
                         ": the file did not come out whole; is the disk full?\n");
    CHECK(copies.files().empty());
}

TEST_CASE("a terminal that is closed stops a run, and leaves no part of a file") {
    const Copies copies(4000);
    const auto ran = call_shell(
        "env --default-signal=HUP " + copies.run() + "--progress none & pid=$!; until [ -e " +
        (copies.scratch / "out/o.0003.vdb") + " ]; do sleep 0.02; done; kill -HUP $pid; wait $pid");
    CHECK(ran.code == 130);
    const auto files = copies.files();
    CHECK(files.size() > 2);
    CHECK(files.size() < 4000);
    for (const auto& file : files) CHECK_THAT(file, !Catch::Contains(".part"));
}
