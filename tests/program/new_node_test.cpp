#include "tests/support/program.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <utility>

namespace fs = std::filesystem;

namespace {

/// Runs a command that must succeed.
Called must(const std::string& command) {
    auto out = call_shell(command);
    INFO(command << "\n" << out.out << out.err);
    REQUIRE(out.code == 0);
    return out;
}

std::string replaced(std::string text, const std::string& part, const std::string& by) {
    for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += by.size())
        text.replace(at, part.size(), by);
    return text;
}

/// The C++ block of nodes/README.md that begins with a comment with this path, without that line.
std::string block_of_page(const std::string& path) {
    const auto page = Scratch::read(SOURCE_ROOT "/nodes/README.md"),
               begin = "```cpp\n// " + path + "\n";
    const auto at = page.find(begin);
    REQUIRE(at != std::string::npos);
    return page.substr(at + begin.size(),
                       page.find("```\n", at + begin.size()) - at - begin.size());
}

}  // namespace

TEST_CASE("the node that nodes/README.md shows is the one that new-node writes") {
    const Scratch scratch;
    must(FLUIDCARVE_PROGRAM " new-node acme.dense --folder " + (scratch / "dense"));
    for (const auto* const file : {"dense.h", "dense.cpp", "dense_test.cpp"})
        CHECK(block_of_page(file) == Scratch::read(scratch / "dense/" + file));
}

TEST_CASE("what new-node writes builds against an installed fluidcarve, passes its test and runs",
          "[nightly][long]") {
    // A fixed place, so that the compiler's cache knows what was compiled there before.
    const fs::path root = NEW_NODE_FOLDER;
    fs::remove_all(root);
    fs::create_directories(root);
    const auto prefix = (root / "prefix").string();
    must("cmake --install " BUILD_FOLDER " --prefix " + prefix);
    const auto program = prefix + "/bin/fluidcarve ";
    for (const auto* const file :
         {"man/man1/fluidcarve.1", "bash-completion/completions/fluidcarve",
          "zsh/site-functions/_fluidcarve", "fish/vendor_completions.d/fluidcarve.fish",
          "fluidcarve/pipelines/plume.yaml", "fluidcarve/pipelines/schema.json",
          "doc/fluidcarve/README.md", "doc/fluidcarve/carve/README.md",
          "doc/fluidcarve/pipelines/README.md", "doc/fluidcarve/nodes/README.md"}) {
        INFO(file);
        CHECK(fs::file_size(root / "prefix/share" / file) > 1000);
    }
    const auto shipped = call_shell(program + "check " + prefix +
                                    "/share/fluidcarve/pipelines/plume.yaml --set sim=" TEST_DATA
                                    "/plume/plume.####.vdb");
    CHECK(shipped.code == 0);

    // The library alone, as carve/README.md says.
    const auto example = (root / "example").string();
    must("cmake -S " SOURCE_ROOT "/examples -B " + example +
         " -G Ninja " CACHE_OF_COMPILER " -DCMAKE_PREFIX_PATH=" + prefix + " && cmake --build " +
         example);
    const auto carved = must(example + "/carve_grids").out;
    CHECK(std::ranges::count(carved, '\n') == 6);
    CHECK(carved.starts_with("frame 1: "));
    CHECK(must("ldd " + example + "/carve_grids").out.find("fluidcarve") == std::string::npos);

    for (const std::string kind : {"energy", "solver"}) {
        const auto name = kind == "energy" ? "sparkle" : "straight";
        const auto library = std::string("acme_") + name;
        const auto folder = (root / library).string();
        must(program + "new-node acme." + name + (kind == "solver" ? " --solver" : "") +
             " --folder " + folder);
        must("cmake -S " + folder + " -B " + folder +
             "/build -G Ninja " CACHE_OF_COMPILER " -DCMAKE_PREFIX_PATH=" + prefix);
        must("cmake --build " + folder + "/build && ctest --test-dir " + folder + "/build");

        const auto pipeline = folder +
                              "/example.yaml --set volumes=" TEST_DATA
                              "/plume/plume.####.vdb --set frames=51-52 --set out=" +
                              folder + "/out.####.vdb --work " + folder + "/work ";
        const auto refused = call_shell(program + "run --progress none " + pipeline);
        CHECK(refused.code == 2);
        CHECK(replaced(refused.err, folder + "/", "") ==
              "example.yaml:3:11: the plugin build/" + library +
                  ".so is not loaded: it is code that would run with your rights, and nobody "
                  "allowed that; if you "
                  "trust build/" +
                  library +
                  ".so, give --allow-plugins, or name a folder that holds it, and that only you "
                  "may write to, in the environment variable "
                  "FLUIDCARVE_PLUGINS\nplugins: [build/" +
                  library + ".so]\n          ^\n");
        CHECK(!fs::exists(folder + "/out.0051.vdb"));

        must(program + "run --progress none --allow-plugins " + pipeline);
        CHECK(fs::exists(folder + "/out.0051.vdb"));
        CHECK(fs::exists(folder + "/out.0052.vdb"));
        CHECK(must(program + "plan --allow-plugins " + pipeline)
                  .out.find("nothing to do: every result is there") != std::string::npos);

        const auto file = folder + "/build/" + library + ".so";
        CHECK(must(program + "nodes acme." + name + " --plugin " + file)
                  .out.starts_with(std::string("acme.") + name + "\n"));
        CHECK(must(program + "schema --plugin " + file)
                  .out.find(std::string("\"acme.") + name + "\"") != std::string::npos);
        std::ofstream(file, std::ios::app) << "as if built again";
        CHECK(must(program + "plan --allow-plugins " + pipeline)
                  .out.find("its plugin was built again") != std::string::npos);
    }
    fs::remove_all(root);
}

TEST_CASE("what new-node writes in Python passes its test and runs") {
    const Scratch scratch;
    const auto folder = scratch / "glow";
    must(FLUIDCARVE_PROGRAM " new-node acme.glow --python --folder " + folder);
    must("cd " + folder + " && /usr/bin/python3 -m unittest glow_test");
    const auto run = std::string("FLUIDCARVE_PYTHON=/usr/bin/python3 " FLUIDCARVE_PROGRAM
                                 " run --progress none ") +
                     folder +
                     "/example.yaml --set volumes=" TEST_DATA
                     "/plume/plume.####.vdb --set frames=51 --set out=" +
                     folder + "/out.####.vdb";
    const auto refused = call_shell(run);
    CHECK(refused.code == 2);
    CHECK(refused.err.find("example.yaml:14:18: energy.python runs code that the pipeline names, "
                           "with your rights, and nobody allowed that; if you trust it, give "
                           "--allow-plugins\n") != std::string::npos);
    must(run + " --allow-plugins");
    CHECK(fs::exists(folder + "/out.0051.vdb"));
    CHECK(must(FLUIDCARVE_PROGRAM " explain " + folder + "/out.0051.vdb")
              .out.find(" --allow-plugins") != std::string::npos);
    const auto outside =
        call_shell("mkdir " + (scratch / "elsewhere") + "; " + run +
                   " --allow-plugins --confine tests/data --confine " + (scratch / "elsewhere"));
    CHECK(outside.code == 2);
    CHECK(outside.err.find("energy.python parameter 'script': " + folder + "/glow.py leads ") !=
          std::string::npos);
}

TEST_CASE("new-node overwrites nothing, and refuses names that can't be") {
    const Scratch scratch;
    const auto called = [&](const std::string& arguments) {
        return replaced(fluidcarve_program("new-node " + arguments).err, scratch.path() + "/", "");
    };
    scratch.write("mine.txt", "");
    CHECK(
        called("acme.sparkle --folder " + scratch.path())
            .find(
                "already exists and is not overwritten; choose another --folder, or remove it\n") !=
        std::string::npos);
    CHECK(
        called("acme.sparkle --folder " + (scratch / "mine.txt")) ==
        "mine.txt already exists and is not overwritten; choose another --folder, or remove it\n");
    const auto folder = " --folder " + (scratch / "new");
    CHECK(called("energy.sparkle" + folder) ==
          "'energy.sparkle' can't name a new node type: the family 'energy' is a built-in one, of "
          "'energy.ax'; use one of your own, such as acme.sparkle\n");
    for (const std::string name :
         {"sparkle", "Acme.sparkle", "acme.", "acme.two.dots", "acme.a__b", "../acme.x", "acme.9"})
        CHECK(called("'" + name + "'" + folder) ==
              "'" + name +
                  "' can't name a new node type: a name is FAMILY.NAME, such as acme.sparkle, in "
                  "lower-case letters, digits and single _\n");
    CHECK(called("acme.plugin" + folder) ==
          "'acme.plugin' can't name a new node type: its source would be plugin.cpp, which every "
          "plugin has for another purpose; choose another name\n");
    CHECK(!fs::exists(scratch / "new"));
    CHECK(fluidcarve_program("new-node acme.sparkle" + folder).code == 0);
}

TEST_CASE("a pipeline whose plugin can't be used is refused where it names it") {
    const Scratch scratch;
    for (const std::string name :
         {"other_abi", "other_payloads", "no_header", "no_entry", "unresolved", "throws_half_way",
          "throws_number", "foreign_type"}) {
        INFO(name);
        const auto pipeline =
            scratch.write("p.yaml", "fluidcarve: 1\nplugins: [" PLUGINS "/" + name +
                                        ".so]\nnodes:\n  a: {type: acme.grow}\n");
        for (const std::string verb : {"run", "check", "plan", "graph"}) {
            const auto out = fluidcarve_program(verb + " --allow-plugins " + pipeline);
            CHECK(out.code == 2);
            CHECK(out.err.starts_with(pipeline + ":2:11: "));
            CHECK(out.err.find(name + ".so ") != std::string::npos);
        }
    }
    const auto good = scratch.write("p.yaml", "fluidcarve: 1\nplugins: [" PLUGINS
                                              "/whole.so]\nnodes:\n  a: {type: acme.grow}\n");
    CHECK(fluidcarve_program("check --allow-plugins " + good).code == 0);
    CHECK(call_shell("FLUIDCARVE_PLUGINS=" PLUGINS " " FLUIDCARVE_PROGRAM " run --progress none " +
                     good)
              .code == 0);
}

TEST_CASE("a plugin that the command line names and that is none is told") {
    const auto out = fluidcarve_program("nodes --plugin README.md");
    CHECK(out.code == 2);
    CHECK(out.err.starts_with("the plugin README.md can't be opened: "));
}
