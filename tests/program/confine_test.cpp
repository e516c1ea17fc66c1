#include "tests/support/program.h"

#include <catch2/catch.hpp>

#include <filesystem>

namespace fs = std::filesystem;

namespace {

/// A folder `shot` with a pipeline and its input, beside a folder `secret`.
class Confined {
public:
    Confined() {
        root = fs::canonical(scratch.path()).string();
        fs::create_directories(root + "/shot");
        fs::create_directories(root + "/secret");
        for (const auto* const folder : {"shot", "secret"})
            for (const auto* const frame : {"0001", "0002"})
                fs::copy_file(TEST_DATA "/vdb/cortex_points.vdb",
                              root + "/" + folder + "/in." + frame + ".vdb");
        write("in.####.vdb", root + "/shot/out/o.####.vdb");
    }
    void write(const std::string& in, const std::string& out, const std::string& top = {}) const {
        scratch.write("shot/p.yaml", "fluidcarve: 1\nframes: 1-2\n" + top +
                                         "nodes:\n  sim: {type: vdb.read, path: \"" + in +
                                         "\"}\n  out: {type: vdb.write, source: sim, path: \"" +
                                         out + "\"}\n");
    }
    Called call(const std::string& verb, const std::string& more = {}) const {
        return fluidcarve_program(verb + " " + root + "/shot/p.yaml --confine " + root + "/shot " +
                                  more);
    }
    Called run(const std::string& more = {}) const {
        return call("run", "--progress none --work " + root + "/shot/kept " + more);
    }
    std::string refusal(const std::string& path) const {
        return " leads to " + path + ", outside of --confine (" + root +
               "/shot); move it there, or name its folder by another --confine\n";
    }
    bool written() const {
        return fs::exists(root + "/shot/out") || fs::exists(root + "/secret/o.0001.vdb");
    }

    Scratch scratch;
    std::string root;
};

}  // namespace

TEST_CASE("a confined pipeline runs within its folders") {
    const Confined at;
    CHECK(at.call("check").code == 0);
    CHECK(at.call("graph").code == 0);
    CHECK(at.call("plan", "--work " + at.root + "/shot/kept").code == 0);
    const auto ran = at.run("--sync --report " + at.root + "/shot/r.json --html " + at.root +
                            "/shot/new/r.html");
    CHECK(ran.err.starts_with("done: 2 frames"));
    CHECK(ran.code == 0);
    CHECK(fs::exists(at.root + "/shot/out/o.0002.vdb"));
    CHECK(fs::exists(at.root + "/shot/new/r.html"));
    CHECK(at.run().code == 0);
}

TEST_CASE(
    "what a confined pipeline reads or writes elsewhere is refused by every verb, at its place") {
    const Confined at;
    at.write("../secret/in.####.vdb", at.root + "/shot/out/o.####.vdb");
    const auto read = at.root + "/shot/p.yaml:4:31: vdb.read parameter 'path': " + at.root +
                      "/shot/../secret/in.0001.vdb" + at.refusal(at.root + "/secret/in.0001.vdb") +
                      "  sim: {type: vdb.read, path: \"../secret/in.####.vdb\"}\n                  "
                      "            ^\n";
    for (const std::string verb : {"check", "plan", "graph", "run"}) {
        INFO(verb);
        const auto called = at.call(verb);
        CHECK(called.err == read);
        CHECK(called.out == "");
        CHECK(called.code == 2);
    }
    CHECK(fluidcarve_program("check " + at.root + "/shot/p.yaml --confine " + at.root +
                             "/shot --confine " + at.root + "/secret")
              .code == 0);

    at.write("in.####.vdb", at.root + "/secret/o.####.vdb");
    const auto wrote = at.call("check");
    CHECK_THAT(wrote.err,
               Catch::Contains("vdb.write parameter 'path': " + at.root + "/secret/o.0001.vdb" +
                               at.refusal(at.root + "/secret/o.0001.vdb")));
    CHECK(wrote.code == 2);
    CHECK_FALSE(at.written());
}

TEST_CASE("links do not lead a confined pipeline out") {
    const Confined at;
    fs::create_symlink("../secret", at.root + "/shot/door");
    at.write("door/in.####.vdb", at.root + "/shot/door/o.####.vdb");
    const auto folder = at.call("check");
    CHECK_THAT(folder.err, Catch::Contains("/shot/door/in.0001.vdb" +
                                           at.refusal(at.root + "/secret/in.0001.vdb")));
    CHECK_THAT(folder.err, Catch::Contains("/shot/door/o.0001.vdb" +
                                           at.refusal(at.root + "/secret/o.0001.vdb")));
    CHECK(folder.code == 2);

    at.write("in.####.vdb", at.root + "/shot/out/o.####.vdb");
    fs::remove(at.root + "/shot/in.0002.vdb");
    fs::create_symlink(at.root + "/secret/in.0002.vdb", at.root + "/shot/in.0002.vdb");
    const auto frame = at.run();
    CHECK_THAT(frame.err,
               Catch::Contains("/shot/in.0002.vdb" + at.refusal(at.root + "/secret/in.0002.vdb")));
    CHECK(frame.code == 2);
    CHECK_FALSE(at.written());
}

TEST_CASE(
    "a confined pipeline extends no file elsewhere, and loads no plugin from there, allowed or "
    "not") {
    const Confined at;
    at.scratch.write("secret/base.yaml",
                     "fluidcarve: 1\nparams: {a: {type: string, default: hunter2}}\n");
    at.write("in.####.vdb", at.root + "/shot/out/o.####.vdb", "extends: ../secret/base.yaml\n");
    const auto extended = at.call("check");
    CHECK(extended.err == at.root + "/shot/p.yaml:3:10: cannot read " + at.root +
                              "/secret/base.yaml: it" + at.refusal(at.root + "/secret/base.yaml") +
                              "extends: ../secret/base.yaml\n         ^\n");
    CHECK(extended.code == 2);

    fs::copy_file(PLUGINS "/whole.so", at.root + "/secret/whole.so");
    at.write("in.####.vdb", at.root + "/shot/out/o.####.vdb", "plugins: [../secret/whole.so]\n");
    const auto plugin = at.call("check", "--allow-plugins");
    CHECK_THAT(plugin.err,
               Catch::Contains("p.yaml:3:11: the plugin ../secret/whole.so is not loaded: it" +
                               at.refusal(at.root + "/secret/whole.so")));
    CHECK(plugin.code == 2);
    CHECK(call_shell("FLUIDCARVE_PLUGINS=" + at.root + "/secret " FLUIDCARVE_PROGRAM " check " +
                     at.root + "/shot/p.yaml --confine " + at.root + "/shot")
              .code == 2);
}

TEST_CASE(
    "the report, the page, the profile and the work folder of a confined run lie within its "
    "folders") {
    const Confined at;
    const auto file = at.root + "/secret/r";
    for (const std::string option : {"--report", "--html", "--profile"}) {
        const auto ran = at.run(option + " " + file);
        CHECK(ran.err == option + ": " + file + at.refusal(file));
        CHECK(ran.code == 2);
    }
    const auto work = at.call("run", "--work " + at.root + "/secret");
    CHECK(work.err == "--work: " + at.root + "/secret" + at.refusal(at.root + "/secret"));
    CHECK(work.code == 2);
    fs::create_directories(at.root + "/shot/kept");
    fs::create_symlink(at.root + "/secret", at.root + "/shot/kept/cache");
    const auto part = at.run();
    CHECK(part.err == "--work: " + at.root + "/shot/kept" + at.refusal(at.root + "/secret"));
    CHECK(part.code == 2);
    CHECK_FALSE(at.written());
}

TEST_CASE("a folder to confine to must exist") {
    const Confined at;
    const auto called = at.call("check", "--confine " + at.root + "/none");
    CHECK(called.err == "--confine must be a folder that exists, not '" + at.root + "/none'\n");
    CHECK(called.code == 2);
    CHECK(at.call("check", "--confine ''").code == 2);
}
