#include "tests/support/program.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <unistd.h>
#include <filesystem>
#include <string>

namespace {

constexpr auto copying =
    "fluidcarve: 1\nframes: 1\nnodes:\n  sim: {type: vdb.read, path: in.####.vdb}\n  out: {type: "
    "vdb.write, source: sim, path: \"{}\"}\n";

/// A folder with a pipeline that copies a volume.
struct Copying {
    Copying() {
        std::filesystem::copy_file(TEST_DATA "/vdb/cortex_points.vdb", scratch / "in.0001.vdb");
        auto text = std::string(copying);
        text.replace(text.find("{}"), 2, scratch / "out.####.vdb");
        scratch.write("p.yaml", text);
    }
    std::string out() const { return scratch / "out.0001.vdb"; }
    Called run(const std::string& limits, const std::string& options = "--no-cache") const {
        return call_shell(limits +
                          "timeout -s KILL 60 " FLUIDCARVE_PROGRAM " run --progress none " +
                          scratch.path() + "/p.yaml " + options);
    }
    Scratch scratch;
};

#if defined(__SANITIZE_ADDRESS__)
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

}  // namespace

TEST_CASE("a limit below what libraries need is told, before one of them crashes") {
    if (sanitized) return;
    for (const std::string verb : {"nodes", "inspect " TEST_DATA "/vdb/cortex_points.vdb"}) {
        const auto little = call_shell("ulimit -v 102400; " FLUIDCARVE_PROGRAM " " + verb);
        CHECK(little.err ==
              "failed: fluidcarve needs 256 MiB of address space at least; raise the limit (ulimit "
              "-v)\n");
        CHECK(little.code == 1);
        const auto flat = call_shell("ulimit -s 64; " FLUIDCARVE_PROGRAM " " + verb);
        CHECK(flat.err ==
              "failed: fluidcarve needs a stack of 1 MiB at least; raise the limit (ulimit -s)\n");
        CHECK(flat.code == 1);
    }
}

TEST_CASE("a pipeline may be deeper than the program's stack") {
    if (sanitized) return;
    constexpr int depth = 9'500;
    std::string yaml = "fluidcarve: 1\nframes: 51-52\nnodes:\n";
    for (int n = 0; n < depth; ++n)
        yaml +=
            fmt::format("  n{}: {{type: energy.remap, range: [0, 1], energy: n{}}}\n", n, n + 1);
    yaml +=
        fmt::format("  n{}: {{type: energy.remap, range: [0, 1], energy: sim.density}}\n", depth);
    yaml += "  sim: {type: vdb.read, path: " TEST_DATA
            "/plume/plume.####.vdb, grids: {density: float}}\n";
    const Scratch scratch;
    const auto file = scratch.write("deep.yaml", yaml);
    for (const std::string verb : {"check ", "plan "}) {
        const auto called = call_shell("ulimit -s 1024; cd " + scratch.path() + "; " +
                                       FLUIDCARVE_PROGRAM " " + verb + file);
        INFO(called.err.substr(0, 500));
        CHECK(called.code == 0);
    }
}

TEST_CASE("without threads the program says so, and is not ended by a signal") {
    // Root has no limit of threads.
    const std::string nobody =
        geteuid() == 0 ? "setpriv --reuid=54321 --regid=54321 --clear-groups " : "";
    if (call_shell(nobody + FLUIDCARVE_PROGRAM " --version").code != 0) {
        WARN("skipped: the build is for its owner alone");
        return;
    }
    for (const int threads : {1, 3, 5, 7, 9}) {
        INFO(threads);
        const auto called =
            call_shell(fmt::format("cd /tmp; {}prlimit --nproc={} {} run --threads 8 --no-cache "
                                   "--progress none {}/plume.yaml",
                                   nobody, threads, FLUIDCARVE_PROGRAM, SOURCE_ROOT "/pipelines"));
        CHECK_THAT(called.err,
                   Catch::Contains("failed: the system starts no more threads; raise its limit "
                                   "(ulimit -u), or give a smaller --threads\n"));
        CHECK(called.code == 1);
    }
}

TEST_CASE("without a free descriptor a run ends, and its output is whole or absent") {
    const Copying copying;
    for (int descriptors = 4; descriptors < 12; ++descriptors) {
        INFO(descriptors);
        std::filesystem::remove(copying.out());
        const auto called = copying.run(fmt::format("exec 2>&1; ulimit -n {}; ", descriptors));
        // 127: not even the loader has one.
        CHECK((called.code < 4 || called.code == 127));
        CHECK((called.code == 0) == std::filesystem::exists(copying.out()));
        if (called.code == 0) CHECK(std::filesystem::file_size(copying.out()) > 38'000);
    }
}
