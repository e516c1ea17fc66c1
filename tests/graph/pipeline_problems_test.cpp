#include "graph/build_pipeline.h"
#include "graph/pipeline.h"
#include "graph/types/node_type.h"
#include "tests/graph/pipeline_cases.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

TEST_CASE("all that is wrong with a file is told at once, in the order of its places") {
    CHECK(problems(R"(fluidcarve: 1
frames: 5-
params:
  by: {type: float, default: much}
nodes:
  n: {type: toy.count, path: "a.<fram>", lat: true}
  n: {type: toy.count, path: b.##}
  m: {type: toy.ad, numbers: n}
  t: {type: toy.total, number: s, start: n}
)",
                   {"bye=1", "m.numbers=s"}) ==
          "--set:1:1: there is no param 'bye'; did you mean 'by'?\nbye=1\n^\n"
          "p.yaml:2:9: frames: '5-' is no frame or range; write 1001, 1001-1084 or "
          "1001-1084x2\nframes: 5-\n        ^\n"
          "p.yaml:4:30: param 'by' must be a number, not 'much'\n  by: {type: float, default: "
          "much}\n                             ^\n"
          "p.yaml:6:30: toy.count parameter 'path' has '<fram>', which is no frame token; did you "
          "mean '<frame>'?\n"
          "  n: {type: toy.count, path: \"a.<fram>\", lat: true}\n                             ^\n"
          "p.yaml:6:42: toy.count has no parameter 'lat'; did you mean 'late'?\n"
          "  n: {type: toy.count, path: \"a.<fram>\", lat: true}\n                                 "
          "        ^\n"
          "p.yaml:7:3: 'n' is stated twice\n  n: {type: toy.count, path: b.##}\n  ^\n"
          "p.yaml:6:3: first stated here\n  n: {type: toy.count, path: \"a.<fram>\", lat: true}\n  "
          "^\n"
          "p.yaml:8:13: there is no node type 'toy.ad'; did you mean 'toy.add'?\n  m: {type: "
          "toy.ad, numbers: n}\n            ^\n"
          "p.yaml:9:32: there is no node 's'; known: m, n, t\n  t: {type: toy.total, number: s, "
          "start: n}\n                               ^\n");
}

TEST_CASE("what only looks like a frame token is named with the nearest that is one") {
    const auto with = [](const std::string& path) {
        return problems("fluidcarve: 1\nnodes:\n  n:\n    type: toy.count\n    path: \"" + path +
                        "\"\n");
    };
    const auto refused = [](const std::string& path, const std::string& token,
                            const std::string& remedy) {
        return "p.yaml:5:11: toy.count parameter 'path' has '" + token +
               "', which is no frame token; " + remedy + "\n    path: \"" + path +
               "\"\n          ^\n";
    };
    CHECK(with("a.<fram>") == refused("a.<fram>", "<fram>", "did you mean '<frame>'?"));
    CHECK(with("a.<frame4>") == refused("a.<frame4>", "<frame4>", "did you mean '<frame04>'?"));
    CHECK(with("a.%4d") == refused("a.%4d", "%4d", "did you mean '%04d'?"));
    CHECK(with("a.$f4") == refused("a.$f4", "$f4", "did you mean '$F4'?"));
    CHECK(with("a.@@@@") == refused("a.@@@@", "@@@@", "use ####, %04d, $F4 or <frame>"));
    CHECK(with("$JOB/a.##") == refused("$JOB/a.##", "$JOB", "use ####, %04d, $F4 or <frame>"));
}

TEST_CASE(
    "writers need a frame token exactly where they run per frame, and never write over an input or "
    "each other") {
    CHECK(problems("fluidcarve: 1\nnodes:\n  n: {type: toy.count, path: a.##}\n  p: {type: "
                   "toy.print, number: n, path: out}\n") ==
          "p.yaml:4:41: toy.print writes a file for every frame: 'path' needs a frame token such "
          "as ####\n  p: {type: toy.print, number: n, path: out}\n"
          "                                        ^\n");
    CHECK(problems("fluidcarve: 1\nnodes:\n  n: {type: toy.count, path: a}\n  p: {type: toy.print, "
                   "number: n, path: out.##}\n") ==
          "p.yaml:4:41: toy.print writes one file here, not one per frame: 'path' can't have a "
          "frame token\n  p: {type: toy.print, number: n, path: out.##}\n"
          "                                        ^\n");
    CHECK(problems("fluidcarve: 1\nnodes:\n  n: {type: toy.count, path: /a/b.##}\n  p: {type: "
                   "toy.print, number: n, path: /a/./b.%02d}\n") ==
          "p.yaml:4:41: 'p' would overwrite a file of the same pipeline\n  p: {type: toy.print, "
          "number: n, path: /a/./b.%02d}\n                                "
          "        ^\n"
          "p.yaml:3:30: 'n' reads it here\n  n: {type: toy.count, path: /a/b.##}\n                 "
          "            ^\n");
}

TEST_CASE(
    "where a sequence is read as one file, the reader is at fault and not what is written per "
    "frame") {
    const auto told = [](const std::string& in) {
        return problems("fluidcarve: 1\nframes: 1-6\nnodes:\n  n: {type: toy.count, path: " + in +
                        "}\n  p: {type: toy.print, number: n, path: out.##}\n");
    };
    const auto fault = [](const std::string& in, const std::string& remedy) {
        return "p.yaml:4:30: toy.count reads one file for all 6 frames, but 'p' writes one for "
               "each: 'path' needs a frame token, " +
               remedy + "; or take the token from 'p'\n  n: {type: toy.count, path: " + in +
               "}\n                             ^\n"
               "p.yaml:5:41: 'p' writes a file per frame here\n  p: {type: toy.print, number: n, "
               "path: out.##}\n"
               "                                        ^\n";
    };
    CHECK(told("in.0001.txt") == fault("in.0001.txt", "as in 'in.####.txt'"));
    CHECK(told("in.txt") == fault("in.txt", "such as ####"));
    // Of several readers, the one whose file's name has a number.
    CHECK_THAT(problems("fluidcarve: 1\nframes: 1-6\nnodes:\n  a: {type: toy.count, path: "
                        "rig.txt}\n  b: {type: toy.count, path: in.07.txt}\n"
                        "  c: {type: toy.add, numbers: [a, b]}\n  p: {type: toy.print, number: c, "
                        "path: out.##}\n"),
               Catch::StartsWith("p.yaml:5:30: toy.count reads one file for all 6 frames, but 'p' "
                                 "writes one for each: 'path' needs a frame token, as in "
                                 "'in.##.txt'; or take the token from 'p'\n"));
    // What is gathered from all frames is written once, and rightly read.
    CHECK(problems("fluidcarve: 1\nframes: 1-6\nnodes:\n  n: {type: toy.count, path: in.##}\n  t: "
                   "{type: toy.total, number: n}\n"
                   "  p: {type: toy.print, number: t, path: out.##}\n") ==
          "p.yaml:6:41: toy.print writes one file here, not one per frame: 'path' can't have a "
          "frame token\n"
          "  p: {type: toy.print, number: t, path: out.##}\n                                       "
          " ^\n");
}

TEST_CASE("a later frame of a pattern is not written over either") {
    CHECK(problems("fluidcarve: 1\nframes: 1-9\nnodes:\n  n: {type: toy.count, path: /a/b.07}\n  "
                   "c: {type: toy.count, path: /a/c.##}\n"
                   "  p: {type: toy.print, number: c, path: /a/b.##}\n") ==
          "p.yaml:6:41: 'p' would overwrite a file of the same pipeline\n  p: {type: toy.print, "
          "number: c, path: /a/b.##}\n"
          "                                        ^\n"
          "p.yaml:4:30: 'n' reads it here\n  n: {type: toy.count, path: /a/b.07}\n                 "
          "            ^\n");
}

TEST_CASE("patterns whose frames never meet may share a folder") {
    CHECK(problems("fluidcarve: 1\nframes: 1-9\nnodes:\n  n: {type: toy.count, path: a.##}\n  p: "
                   "{type: toy.print, number: n, path: a.###}\n") == "");
}

TEST_CASE("two writers to one file are refused, both places named") {
    CHECK(problems("fluidcarve: 1\nframes: 1-9\nnodes:\n  n: {type: toy.count, path: a.##}\n  p: "
                   "{type: toy.print, number: n, path: out/o.$F2}\n"
                   "  q: {type: toy.print, number: n, path: out/../out/o.%02d}\n") ==
          "p.yaml:6:41: 'q' would overwrite a file of the same pipeline\n  q: {type: toy.print, "
          "number: n, path: out/../out/o.%02d}\n"
          "                                        ^\n"
          "p.yaml:5:41: 'p' writes it here\n  p: {type: toy.print, number: n, path: out/o.$F2}\n   "
          "                                     ^\n");
}

TEST_CASE("a file is the same by whatever path: relative, through dots or through links") {
    namespace fs = std::filesystem;
    const Scratch scratch;
    fs::create_directories(scratch / "real/3");
    fs::create_directory_symlink(scratch / "real", scratch / "link");
    scratch.write("real/in.03", "");
    scratch.write("real/3/in", "");
    fs::create_symlink(scratch / "real/in.03", scratch / "published.03");
    const auto relative = fs::relative(scratch.path()).string();
    const auto clash = [&](const std::string& in, const std::string& out) {
        const auto text =
            check(scratch,
                  "fluidcarve: 1\nframes: 1-9\nnodes:\n  n:\n    type: toy.count\n    path: " + in +
                      "\n  p:\n    type: toy.print\n    number: n\n    path: " + out + "\n")
                .text;
        const auto first = text.substr(0, text.find('\n'));
        return text.empty() ? text
                            : first + text.substr(text.find("^\n") + 1,
                                                  text.rfind(" here") - text.find("^\n") - 1);
    };
    const auto both =
        "p.yaml:10:11: 'p' would overwrite a file of the same pipeline\np.yaml:6:11: 'n' reads it";
    const auto real = scratch / "real/in.##";
    CHECK(clash(real, scratch / "link/in.##") == both);
    CHECK(clash(real, scratch / "link/./../link/in.$F2") == both);
    CHECK(clash(real, relative + "/real/in.##") == both);
    CHECK(clash(relative + "/./link/in.##", real) == both);
    CHECK(clash(scratch / "real/#/in", scratch / "link/<frame>/in") == both);
    CHECK(clash(scratch / "published.##", real) == both);
    fs::create_directories(scratch / "other");
    CHECK(clash(real, scratch / "other/in.##") == "");
    CHECK(clash(real, scratch / "new/in.##") == "");
    CHECK(clash(real, scratch / "in.##") == "");
}

TEST_CASE("a pipeline never writes over itself") {
    const Scratch scratch;
    CHECK(check(scratch,
                "fluidcarve: 1\nnodes:\n  n: {type: toy.count, path: in}\n  p:\n    type: "
                "toy.print\n    number: n\n    path: " +
                    scratch / "./p.yaml" + "\n")
              .text ==
          "p.yaml:7:11: 'p' would overwrite a file of the same pipeline\n    path: ./p.yaml\n      "
          "    ^\np.yaml: this is the pipeline itself\n");
}

TEST_CASE("a faulty reader does not make its writer look faulty too") {
    CHECK(problems("fluidcarve: 1\nnodes:\n  n: {type: toy.count, path: a.##, late: maybe}\n  p: "
                   "{type: toy.print, number: n, path: out.##}\n") ==
          "p.yaml:3:42: toy.count parameter 'late' must be true or false, not 'maybe'\n  n: {type: "
          "toy.count, path: a.##, late: maybe}\n"
          "                                         ^\n");
}

TEST_CASE("very many problems are cut short, and so is a long list of names") {
    std::string yaml = "fluidcarve: 1\nnodes:\n  n: {type: toy.count, path: a.##}\n";
    for (int n = 0; n < 150; ++n)
        yaml += fmt::format("  node{0}: {{type: toy.add, numbers: zzzzzzzzzzzz}}\n", n);
    const auto text = problems(yaml);
    CHECK_THAT(text,
               Catch::Contains("and 139 more\n") && Catch::EndsWith("... and 50 more problems\n"));
}

TEST_CASE("the frame set is checked where it stands") {
    const auto with = [](const std::string& frames) {
        return problems("fluidcarve: 1\nframes: " + frames +
                        "\nnodes:\n  n: {type: toy.count, path: a.##}\n");
    };
    const auto refused = [](const std::string& frames, const std::string& why) {
        return "p.yaml:2:9: frames: " + why + "\nframes: " + frames + "\n        ^\n";
    };
    CHECK(with("\"\"") ==
          refused("\"\"", "no frame is named; write 1001, 1001-1084 or 1001-1084x2"));
    CHECK(with("[1, 2]") ==
          refused("[1, 2]", "must be a frame set such as 1001-1084, not a list of 2"));
    CHECK(with("1-10x0") == refused("1-10x0", "'1-10x0' has a step of 0; the least is 1"));
    CHECK(with("1-2000000") == refused("1-2000000", "'1-2000000' names more than 1000000 frames"));
    CHECK(with("1-99999999999") ==
          refused("1-99999999999",
                  "'1-99999999999' has a number beyond 2147483647, the most that a frame can be"));
    for (const std::string bad : {"10-x", "5-", "a-b"})
        CHECK(with(bad) ==
              refused(bad,
                      "'" + bad + "' is no frame or range; write 1001, 1001-1084 or 1001-1084x2"));
}

TEST_CASE("settings reach params and node fields, and are checked like the file") {
    const auto [pipeline, text] =
        check(Scratch(), good, {"by=7", "count.late=true", "total.only_place=2"});
    REQUIRE(text == "");
    CHECK(static_cast<const toy::Add::Params*>(pipeline.find("more")->params.get())->offset == 7);
    CHECK(static_cast<const toy::Count::Params*>(pipeline.find("count")->params.get())->late);
    CHECK(problems(good, {"bye=7"}) ==
          "--set:1:1: there is no param 'bye'; did you mean 'by'?\nbye=7\n^\n");
    CHECK(problems(good, {"cuont.late=true"}) ==
          "--set:1:1: there is no node 'cuont'; did you mean 'count'?\ncuont.late=true\n^\n");
    CHECK(problems(good, {"count.lat=true"}) ==
          "--set:1:7: toy.count has no parameter 'lat'; did you mean 'late'?\ncount.lat=true\n     "
          " ^\n");
    CHECK(problems(good, {"by=70"}) ==
          "--set:1:4: param 'by' must be from 0 to 10, not 70\nby=70\n   ^\n");
    CHECK(problems(good, {"count.=true"}) ==
          "--set:1:7: toy.count has no parameter ''; known: path, fail_at, missing, late, "
          "skip\ncount.=true\n      ^\n");
    CHECK(problems(good, {".late=true"}) ==
          "--set:1:1: there is no node ''; known: count, more, total, print\n.late=true\n^\n");
    CHECK(problems(good, {"count.late={a: "}) ==
          "--set:1:1: not YAML: end of map flow not found\ncount.late={a: \n^\n");
    CHECK(problems(good, {"count.type=toy.cuont"}) ==
          "--set:1:12: there is no node type 'toy.cuont'; did you mean "
          "'toy.count'?\ncount.type=toy.cuont\n           ^\n");
    CHECK(problems(good, {"by"}) == "--set:1:1: must be NODE.FIELD=VALUE or PARAM=VALUE\nby\n^\n");
}
