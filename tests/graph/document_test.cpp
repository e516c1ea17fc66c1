#include "graph/document.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>
#include <cstdlib>
#include <ctime>
#include <filesystem>

using namespace fluidcarve;

namespace {

struct Read {
    Document document;
    std::string text;

    std::string field(const std::string& node, const std::string& name) const {
        const auto* const found = document.nodes.find(node);
        const auto* const field = found ? found->value.find(name) : nullptr;
        return field ? field->value.text : "(none)";
    }
};

Read read(const Scratch& scratch, const std::string& yaml,
          const std::vector<std::string>& settings = {}) {
    Problems problems_of;
    Read out{read_document(scratch.write("p.yaml", yaml), settings, problems_of), {}};
    out.text = to_text(problems_of);
    for (std::size_t at; (at = out.text.find(scratch.path() + "/")) != std::string::npos;)
        out.text.erase(at, scratch.path().size() + 1);
    return out;
}

std::string problems_of(const std::string& yaml) { return read(Scratch(), yaml).text; }

}  // namespace

TEST_CASE("a param keeps its type where it is the whole value, and is text inside text") {
    const auto out = read(Scratch(), R"(fluidcarve: 1
params:
  size: {type: vector, default: [1, 2, 3]}
  shot: {type: string, default: sh010}
nodes:
  a: {type: x, whole: "${size}", inside: "out/${shot}/${shot}.vdb", plain: $F4 costs $}
)");
    REQUIRE(out.text == "");
    CHECK(out.document.nodes.find("a")->value.find("whole")->value.items.size() == 3);
    CHECK(out.field("a", "inside") == "out/sh010/sh010.vdb");
    CHECK(out.field("a", "plain") == "$F4 costs $");
}

TEST_CASE("what a param holds is not replaced again") {
    setenv("FLUIDCARVE_TEST_SHOT", "${other}", 1);
    const auto out = read(Scratch(),
                          "fluidcarve: 1\nenv: [FLUIDCARVE_TEST_SHOT]\nnodes:\n  a: {type: x, f: "
                          "\"${FLUIDCARVE_TEST_SHOT}\"}\n");
    const auto over_param =
        read(Scratch(),
             "fluidcarve: 1\nenv: [FLUIDCARVE_TEST_SHOT]\nparams:\n  FLUIDCARVE_TEST_SHOT: {type: "
             "string, default: a}\nnodes:\n  a: {type: "
             "x, f: \"${FLUIDCARVE_TEST_SHOT}\"}\n");
    unsetenv("FLUIDCARVE_TEST_SHOT");
    CHECK(out.text == "");
    CHECK(out.field("a", "f") == "${other}");
    CHECK(over_param.text == "");
    CHECK(over_param.field("a", "f") == "${other}");
}

TEST_CASE("later layers win: default, extended file, file, environment, command line") {
    const Scratch scratch;
    scratch.write("base.yaml", R"(fluidcarve: 1
params:
  depth: {type: int, default: 1, max: 100}
frames: 1-5
nodes:
  a: {type: x, one: base, two: base, three: base, depth: "${depth}"}
  b: {type: y}
)");
    const std::string file = R"(fluidcarve: 1
extends: base.yaml
env: [depth]
params:
  depth: {default: 2}
nodes:
  a: {two: file, three: }
  c: {type: z}
)";
    auto out = read(scratch, file);
    REQUIRE(out.text == "");
    CHECK(out.field("a", "type") == "x");
    CHECK(out.field("a", "one") == "base");
    CHECK(out.field("a", "two") == "file");
    CHECK(out.field("a", "three") == "(none)");
    CHECK(out.field("b", "type") == "y");
    CHECK(out.field("c", "type") == "z");
    CHECK(out.field("a", "depth") == "2");
    CHECK(out.document.frames.text == "1-5");

    setenv("depth", "3", 1);
    CHECK(read(scratch, file).field("a", "depth") == "3");
    CHECK(read(scratch, file, {"depth=4", "a.one=set"}).field("a", "depth") == "4");
    CHECK(read(scratch, file, {"depth=4", "a.one=set"}).field("a", "one") == "set");
    setenv("depth", "300", 1);
    CHECK(read(scratch, file).text ==
          "environment variable depth:1:1: param 'depth' must be at most 100, not 300\n300\n^\n");
    unsetenv("depth");
}

TEST_CASE("the frames are set like a param, unless a param has their name") {
    const std::string nodes = "nodes:\n  a: {type: x, f: \"${frames}\"}\n";
    CHECK(read(Scratch(), "fluidcarve: 1\nframes: 1-3\nnodes:\n  a: {type: x}\n",
               {"frames=1001-1084"})
              .document.frames.text == "1001-1084");
    const auto param =
        read(Scratch(),
             "fluidcarve: 1\nframes: 1-3\nparams:\n  frames: {type: int, default: 1}\n" + nodes,
             {"frames=7"});
    CHECK(param.document.frames.text == "1-3");
    CHECK(param.field("a", "f") == "7");
}

TEST_CASE("extended files that are missing, or extend each other in a circle, are named") {
    const Scratch scratch;
    CHECK(read(scratch, "fluidcarve: 1\nextends: nowhere.yaml\n").text ==
          "p.yaml:2:10: cannot read nowhere.yaml: it does not exist\nextends: nowhere.yaml\n       "
          "  ^\n");
    scratch.write("q.yaml", "fluidcarve: 1\nextends: p.yaml\n");
    CHECK(read(scratch, "fluidcarve: 1\nextends: q.yaml\n").text ==
          "q.yaml:2:10: p.yaml extends itself, directly or through others\nextends: p.yaml\n       "
          "  ^\n");
    std::filesystem::create_symlink("loop.yaml", scratch.path() + "/loop.yaml");
    for (const auto& name : {std::string("loop.yaml"), std::string(300, 'x')})
        CHECK_THAT(read(scratch, "fluidcarve: 1\nextends: " + name + "\n").text,
                   Catch::StartsWith("p.yaml:2:10: cannot read " + name));
}

TEST_CASE("an extended file that is no pipeline is named, and nothing of it is shown") {
    const Scratch scratch;
    const auto told = [&](const std::string& text) {
        scratch.write("secret.yml", text);
        return read(scratch, "fluidcarve: 1\nextends: secret.yml\n").text;
    };
    const std::string here = "p.yaml:2:10: it is extended here\nextends: secret.yml\n         ^\n";
    const std::string no_pipeline = "no pipeline: it does not state 'fluidcarve: 1'\n" + here;
    CHECK(told("user: hunter2\nhunter2: x\n") == "secret.yml: " + no_pipeline);
    CHECK(told("hunter2\n") == "secret.yml: " + no_pipeline);
    CHECK(told("- hunter2\n") == "secret.yml: " + no_pipeline);
    CHECK(told("extends: hunter2\nrules: hunter2\n") == "secret.yml: " + no_pipeline);
    CHECK(told("fluidcarve: hunter2\n") == "secret.yml: " + no_pipeline);
    CHECK(told("") == "secret.yml: " + no_pipeline);
    CHECK(told("hunter2: 1\nhunter2: 2\n") == "secret.yml: " + no_pipeline);
    CHECK(told("fluidcarve: 1\npassword: [hunter2\n") ==
          "secret.yml:3:1: no pipeline: it does not parse here\n" + here);
    CHECK(told("a: *hunter2\n") == "secret.yml:1:4: no pipeline: it does not parse here\n" + here);
    CHECK(told(std::string("hunter2\0", 8)) ==
          "secret.yml: no pipeline: binary data: a pipeline is a text in UTF-8\n" + here);
    CHECK(told("fluidcarve: 1\nnoodles: 1\n") ==
          "secret.yml:2:1: a pipeline has no field 'noodles'; did you mean 'nodes'?\nnoodles: "
          "1\n^\n");
}

TEST_CASE("a file that extends another may leave the format's version to that") {
    const Scratch scratch;
    scratch.write("base.yaml", "fluidcarve: 1\nnodes:\n  a: {type: x, one: base, two: base}\n");
    scratch.write("middle.yaml", "extends: base.yaml\nnodes:\n  a: {two: middle}\n");
    const auto out = read(scratch, "extends: middle.yaml\nnodes:\n  a: {one: file}\n");
    CHECK(out.text == "");
    CHECK(out.field("a", "one") == "file");
    CHECK(out.field("a", "two") == "middle");
    CHECK(read(scratch, "fluidcarve: 2\nextends: base.yaml\n").text ==
          "p.yaml:1:13: format version '2' is unknown; this program reads version 1\nfluidcarve: "
          "2\n            ^\n");
    scratch.write("base.yaml", "nodes:\n  a: {type: x}\n");
    CHECK(read(scratch, "extends: base.yaml\n").text ==
          "base.yaml: no pipeline: it does not state 'fluidcarve: 1'\np.yaml:1:10: it is extended "
          "here\nextends: base.yaml\n         ^\n");
}

TEST_CASE("a file that is no pipeline is refused in words") {
    CHECK(problems_of("") ==
          "p.yaml: the file is empty: a pipeline starts with 'fluidcarve: 1' and has 'nodes:'\n");
    CHECK(problems_of("- a\n- b\n") ==
          "p.yaml:1:1: a pipeline is a map with 'fluidcarve: 1' and 'nodes:', not a list of 2\n- "
          "a\n^\n");
    CHECK(problems_of("nodes:\n  a: {type: x}\n") ==
          "p.yaml: the format version is missing: the file must state 'fluidcarve: 1'\n");
    CHECK(problems_of("fluidcarve: 2\nnodes:\n  a: {type: x}\n") ==
          "p.yaml:1:13: format version '2' is unknown; this program reads version 1\nfluidcarve: "
          "2\n            ^\n");
    CHECK(problems_of("fluidcarve: 1\nnode:\n  a: {type: x}\n") ==
          "p.yaml:2:1: a pipeline has no field 'node'; did you mean 'nodes'?\nnode:\n^\n");
    CHECK(problems_of("fluidcarve: 1\n") == "p.yaml: the pipeline has no nodes\n");
    CHECK(problems_of("fluidcarve: 1\nnodes:\n") ==
          "p.yaml:2:1: 'nodes' must be a map, not nothing\nnodes:\n^\n");
    CHECK(problems_of(std::string("a\0b", 3)) ==
          "p.yaml: binary data: a pipeline is a text in UTF-8\n");
    CHECK(problems_of("Dear all,\nplease find attached the pipeline that I told you about\n") ==
          "p.yaml:1:1: a pipeline is a map with 'fluidcarve: 1' and 'nodes:', not 'Dear all, "
          "please find attached the pipeline that I told you ...'\n"
          "Dear all,\n^\n");
    CHECK(problems_of("  # a comment\n---\n") ==
          "p.yaml: the file is empty: a pipeline starts with 'fluidcarve: 1' and has 'nodes:'\n");
}

TEST_CASE("a folder or a missing file is named, and nothing else is wrong with it") {
    const Scratch scratch;
    const auto refusal = [&](const std::string& path) {
        Problems problems_of;
        read_document(path, {"size=3", "a.b=3"}, problems_of);
        return to_text(problems_of);
    };
    CHECK(refusal(scratch.path()) == "cannot read " + scratch.path() + ": it is a folder\n");
    CHECK(refusal(scratch / "none.yaml") ==
          "cannot read " + scratch / "none.yaml" + ": it does not exist\n");
    CHECK(refusal(scratch.write("empty.yaml", "")) ==
          scratch / "empty.yaml" +
              ": the file is empty: a pipeline starts with 'fluidcarve: 1' and has 'nodes:'\n");
}

TEST_CASE("a pipe or a device is no pipeline, and keeps nobody waiting") {
    const Scratch scratch;
    const auto pipe = scratch / "pipe.yaml";
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    const std::string refused =
        ": it is a pipe or a device; a pipeline is read from a regular file\n";
    for (const auto& path : {pipe, std::string("/dev/zero")}) {
        Problems problems_of;
        read_document(path, {}, problems_of);
        CHECK(to_text(problems_of) == "cannot read " + path + refused);
    }
    std::filesystem::create_symlink("/dev/zero", scratch / "zero.yaml");
    std::filesystem::create_directory(scratch / "folder");
    for (const std::string name : {"pipe.yaml", "zero.yaml"})
        CHECK(read(scratch, "fluidcarve: 1\nextends: " + name + "\n").text ==
              "p.yaml:2:10: cannot read " + name + refused + "extends: " + name + "\n         ^\n");
    CHECK(read(scratch, "fluidcarve: 1\nextends: folder\n").text ==
          "p.yaml:2:10: cannot read folder: it is a folder\nextends: folder\n         ^\n");
}

TEST_CASE("a file of any size is refused by its limit, and not read to its end") {
    const Scratch scratch;
    const auto path = scratch.write("large.yaml", "");
    std::filesystem::resize_file(path, std::uintmax_t{1} << 32);
    Problems problems_of;
    read_document(path, {}, problems_of);
    CHECK(to_text(problems_of) == path + ": the file holds more than 1 MiB: not a pipeline\n");
}

TEST_CASE("what a user wrote can't command a terminal or break a message's lines") {
    CHECK(problems_of("fluidcarve: 1\n\"node\\nx\": 1\nnodes:\n  a: {type: x}\n") ==
          "p.yaml:2:1: a pipeline has no field 'node x'; did you mean 'nodes'?\n\"node\\nx\": "
          "1\n^\n");
    CHECK_THAT(problems_of("fluidcarve: 1\n\"no\\e[31mde\\nx\": 1\nnodes:\n  a: {type: x}\n"),
               Catch::StartsWith("p.yaml:2:1: the text holds the control character 0x1b, which no "
                                 "name, path or program may: leave it out\n"));
}

TEST_CASE("a frame set that was left empty is not taken for one frame") {
    CHECK(problems_of("fluidcarve: 1\nframes:\nnodes:\n  a: {type: x}\n") ==
          "p.yaml:2:1: 'frames' has no value; name frames such as 1001-1084, or leave the field "
          "out for a single one\nframes:\n^\n");
    const Scratch scratch;
    scratch.write("base.yaml", "fluidcarve: 1\nframes: 1-5\nnodes:\n  a: {type: x}\n");
    const auto out = read(scratch, "fluidcarve: 1\nextends: base.yaml\nframes:\n");
    CHECK(out.text == "");
    CHECK(out.document.frames.kind == Value::Kind::null);
}

TEST_CASE("params are checked against their declaration") {
    CHECK(problems_of("fluidcarve: 1\nparams:\n  n: {default: 1}\nnodes:\n  a: {type: x}\n") ==
          "p.yaml:3:3: param 'n' needs a type: bool, int, float, vector, string, path or count\n  "
          "n: {default: 1}\n  ^\n");
    CHECK(problems_of(
              "fluidcarve: 1\nparams:\n  n: {type: int, default: 1.5}\nnodes:\n  a: {type: x}\n") ==
          "p.yaml:3:27: param 'n' must be a whole number, not '1.5'\n  n: {type: int, default: "
          "1.5}\n                          ^\n");
    CHECK(problems_of(
              "fluidcarve: 1\nparams:\n  n: {type: flaot, default: 1}\nnodes:\n  a: {type: x}\n") ==
          "p.yaml:3:13: param 'n' has no type 'flaot'; did you mean 'float'?\n  n: {type: flaot, "
          "default: 1}\n            ^\n");
    CHECK(problems_of("fluidcarve: 1\nparams:\n  n: {type: int}\nnodes:\n  a: {type: x}\n") ==
          "p.yaml:3:3: param 'n' has no value; give it a default or --set n=...\n  n: {type: "
          "int}\n  ^\n");
    CHECK(
        problems_of(
            "fluidcarve: 1\nparams:\n  n: {type: count, default: 12x}\nnodes:\n  a: {type: x}\n") ==
        "p.yaml:3:29: param 'n' must be a whole number of seams or a percentage such as -10%, not "
        "'12x'\n  n: {type: count, default: 12x}\n                    "
        "        ^\n");
    for (const std::string bad : {"+-5", "%", "nan", "inf%", "1.5", "1e999", "0x10", "5 %"})
        CHECK(problems_of("fluidcarve: 1\nparams:\n  n: {type: count, default: \"" + bad +
                          "\"}\nnodes:\n  a: {type: x}\n") ==
              "p.yaml:3:29: param 'n' must be a whole number of seams or a percentage such as "
              "-10%, not '" +
                  bad + "'\n  n: {type: count, default: \"" + bad +
                  "\"}\n                            ^\n");
    for (const std::string good : {"+5", "-5", "-12.5%", "+10%"})
        CHECK(problems_of("fluidcarve: 1\nparams:\n  n: {type: count, default: \"" + good +
                          "\"}\nnodes:\n  a: {type: x}\n") == "");
}

TEST_CASE("an unknown or unset name in a value is named where it stands") {
    CHECK(problems_of("fluidcarve: 1\nparams:\n  shot: {type: string, default: a}\nnodes:\n  a: "
                      "{type: x, f: \"${shto}\"}\n") ==
          "p.yaml:5:19: ${shto} is neither a param nor declared under 'env'; did you mean "
          "'shot'?\n  a: {type: x, f: \"${shto}\"}\n                  ^\n");
    CHECK(problems_of("fluidcarve: 1\nenv: [FLUIDCARVE_NOT_SET]\nnodes:\n  a: {type: x, f: "
                      "\"${FLUIDCARVE_NOT_SET}\"}\n") ==
          "p.yaml:4:19: the environment variable FLUIDCARVE_NOT_SET is not set\n  a: {type: x, f: "
          "\"${FLUIDCARVE_NOT_SET}\"}\n                  ^\n");
    CHECK(problems_of("fluidcarve: 1\nnodes:\n  a: {type: x, f: \"${shot\"}\n") ==
          "p.yaml:3:19: '${' has no '}'\n  a: {type: x, f: \"${shot\"}\n                  ^\n");
}

TEST_CASE("a small file never grows to a large text") {
    const std::string long_text(400'000, 'x'),
        grows = "here the pipeline grows beyond 16 MiB of text";
    std::string many;
    for (int n = 0; n < 60'000; ++n) many += "${a}";
    const auto params =
        "fluidcarve: 1\nparams: {a: {type: string, default: " + long_text + "}}\nnodes:\n";
    const auto inside = problems_of(params + "  one: {type: x, b: \"" + many +
                                    "\"}\n  two: {type: x, b: \"" + many + "\"}\n");
    CHECK_THAT(inside, Catch::StartsWith("p.yaml:4:21: " + grows));
    CHECK(inside.find(grows) == inside.rfind(grows));

    std::string whole, aliases;
    for (int n = 0; n < 1000; ++n) whole += "\"${a}\", ", aliases += "*a, ";
    CHECK_THAT(problems_of(params + "  one: {type: x, b: [" + whole + "]}\n"),
               Catch::StartsWith("p.yaml:4:") && Catch::Contains(grows));
    CHECK_THAT(problems_of("fluidcarve: 1\nnodes:\n  one: {type: &a " + long_text + ", b: [" +
                           aliases + "]}\n"),
               Catch::StartsWith("p.yaml:3:") && Catch::Contains(grows));
    std::string many_aliases;
    for (int n = 0; n < 20'000; ++n) many_aliases += "*a, ";
    CHECK_THAT(problems_of("fluidcarve: 1\nnodes:\n  one: {type: x, b: &a {" +
                           std::string(1000, 'x') + ": 1}, c: [" + many_aliases + "]}\n"),
               Catch::StartsWith("p.yaml:3:") && Catch::Contains(grows));

    const auto few = read(Scratch(), params + "  one: {type: x, b: \"${a}${a}\"}\n");
    CHECK(few.text == "");
    CHECK(few.field("one", "b").size() == 800'000);
}

TEST_CASE("the text of all extended files counts together") {
    const Scratch scratch;
    std::string aliases;
    for (int n = 0; n < 24; ++n) aliases += "*a, ";
    const auto large = "fluidcarve: 1\nparams:\n  p: {type: string, default: &a " +
                       std::string(400'000, 'x') + ", doc: [" + aliases + "]}\n";
    CHECK_THAT(read(scratch, large).text, !Catch::Contains("16 MiB"));
    scratch.write("base.yaml", large);
    CHECK_THAT(read(scratch, large + "extends: base.yaml\n").text,
               Catch::Contains("no pipeline: here the pipeline grows beyond 16 MiB of text"));
}

TEST_CASE("one name in one text is told once of, however often it is inserted") {
    std::string many;
    for (int n = 0; n < 1000; ++n) many += "${a}";
    const auto out = read(
        Scratch(),
        "fluidcarve: 1\nparams: {a: {type: string, default: x}}\nnodes:\n  one: {type: x, b: \"" +
            many + "\"}\n");
    CHECK(out.document.insertions.size() == 1);
    CHECK(out.field("one", "b") == std::string(1000, 'x'));
}

TEST_CASE("the time to merge two files grows with their length, and not faster") {
    const Scratch scratch;
    std::string base = "fluidcarve: 1\nparams:\n",
                over = "fluidcarve: 1\nextends: base.yaml\nparams:\n";
    for (int n = 0; n < 45'000; ++n) {
        base += "  n" + std::to_string(n) + ": {}\n";
        over += "  n" + std::to_string(n) + ":\n";
    }
    scratch.write("base.yaml", base);
    const auto begin = std::clock();
    CHECK(read(scratch, over).text == "p.yaml: the pipeline has no nodes\n");
    CHECK(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC < 3);
}

TEST_CASE("a path longer than any file's is refused") {
    CHECK_THAT(
        problems_of("fluidcarve: 1\nparams: {a: {type: path, default: " + std::string(5000, 'x') +
                    "}}\nnodes:\n  a: {type: x}\n"),
        Catch::StartsWith("p.yaml:2:35: param 'a' has 5000 bytes; a path has at most 4095\n"));
}
