#include "graph/pipeline.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

namespace {

struct Checked {
    Pipeline pipeline;
    std::string text;  ///< of all problems, the scratch folder cut from the names
};

Checked check(const Scratch& scratch, const std::string& yaml, const std::vector<std::string>& settings = {}) {
    static const Registry registry = toy::registry();
    Problems problems;
    const auto document = read_document(scratch.write("p.yaml", yaml), settings, problems);
    Checked out{build_pipeline(document, registry, problems), to_text(problems)};
    for (std::size_t at; (at = out.text.find(scratch.path() + "/")) != std::string::npos;) out.text.erase(at, scratch.path().size() + 1);
    return out;
}

std::string problems(const std::string& yaml, const std::vector<std::string>& settings = {}) { return check(Scratch(), yaml, settings).text; }

const std::string good = R"(fluidcarve: 1
params:
  from: {type: path, default: in.####.txt, doc: Input.}
  by: {type: float, default: 2.5, min: 0, max: 10}
frames: 1-4
nodes:
  count: {type: toy.count, path: "${from}"}
  more: {type: toy.add, numbers: [count, count.number], offset: "${by}"}
  total: {type: toy.total, number: more}
  print: {type: toy.print, number: more, total: total, path: out.####.txt}
)";

}  // namespace

TEST_CASE("a good pipeline is ordered, connected and has its rates") {
    const auto [pipeline, text] = check(Scratch(), good);
    REQUIRE(text == "");
    CHECK(pipeline.node_names() == std::vector<std::string>{"count", "more", "total", "print"});
    CHECK(pipeline.find("count")->rate == Rate::frame);
    CHECK(pipeline.find("total")->rate == Rate::sequence);
    CHECK(pipeline.find("total")->gathers);
    CHECK(pipeline.find("print")->rate == Rate::frame);
    CHECK(pipeline.find("more")->inputs[0].size() == 2);
    CHECK(static_cast<const toy::Add::Params*>(pipeline.find("more")->params.get())->offset == 2.5);
    CHECK(pipeline.leaves() == std::vector<std::size_t>{3});
}

TEST_CASE("without a frame token a reader, and what hangs on it, is static") {
    const auto [pipeline, text] = check(Scratch(), R"(fluidcarve: 1
nodes:
  count: {type: toy.count, path: in.txt}
  total: {type: toy.total, number: count}
  print: {type: toy.print, number: total, path: out.txt}
)");
    REQUIRE(text == "");
    CHECK(pipeline.find("count")->rate == Rate::fixed);
    CHECK(pipeline.find("total")->rate == Rate::fixed);
    CHECK(pipeline.find("print")->rate == Rate::fixed);
}

TEST_CASE("a typo, a wrong port type and a cycle are reported together, each with its place") {
    Registry registry = toy::registry();
    struct Speak {
        struct Ports {
            Ref<toy::Number> number;
            Ref<toy::Text> text;
        };
        static void run(const fluidcarve::detail::NoParams&, Ports&, Context&) {}
    };
    registry.add(NodeType(Declare<Speak>("toy.speak", "A number in words.")
                              .input("number", &Speak::Ports::number, "The number.")
                              .output("text", &Speak::Ports::text, "The words.")));
    const Scratch scratch;
    const auto path = scratch.write("p.yaml", R"(fluidcarve: 1
nodes:
  count: {type: toy.count, path: in.####.txt}
  words: {type: toy.speak, number: count}
  more:
    type: toy.add
    numbers: [count, words]
    ofset: 2
  a: {type: toy.add, numbers: [b]}
  b: {type: toy.add, numbers: [count, c]}
  c: {type: toy.add, numbers: [a]}
)");
    Problems problems;
    const auto document = read_document(path, {}, problems);
    build_pipeline(document, registry, problems);
    CHECK(to_text(problems) == path +
                                   ":7:22: toy.add input 'numbers' takes number, but words.text is text\n"
                                   "    numbers: [count, words]\n"
                                   "                     ^\n" +
                                   path +
                                   ":4:3: 'words' (toy.speak) stands here\n"
                                   "  words: {type: toy.speak, number: count}\n"
                                   "  ^\n" +
                                   path +
                                   ":8:5: toy.add has no parameter 'ofset'; did you mean 'offset'?\n"
                                   "    ofset: 2\n"
                                   "    ^\n" +
                                   path +
                                   ":9:3: these nodes feed each other in a cycle: a -> c -> b -> a\n"
                                   "  a: {type: toy.add, numbers: [b]}\n"
                                   "  ^\n");
}

TEST_CASE("unknown node types, nodes and ports are named with the nearest name") {
    CHECK(problems("fluidcarve: 1\nnodes:\n  n: {type: toy.cuont, path: a.##}\n") ==
          "p.yaml:3:13: there is no node type 'toy.cuont'; did you mean 'toy.count'?\n  n: {type: toy.cuont, path: a.##}\n            ^\n");
    CHECK(problems("fluidcarve: 1\nnodes:\n  n: {type: toy.subtract}\n") ==
          "p.yaml:3:13: there is no node type 'toy.subtract'; known: toy.add, toy.count, toy.print, toy.share, toy.total\n  n: {type: toy.subtract}\n          "
          "  ^\n");
    CHECK(problems("fluidcarve: 1\nnodes:\n  n: {type: energy}\n") ==
          "p.yaml:3:13: there is no node type 'energy'; `fluidcarve nodes` lists them\n  n: {type: energy}\n            ^\n");
    CHECK(problems("fluidcarve: 1\nnodes:\n  count: {type: toy.count, path: a.##}\n  m: {type: toy.add, numbers: cuont}\n") ==
          "p.yaml:4:31: there is no node 'cuont'; did you mean 'count'?\n  m: {type: toy.add, numbers: cuont}\n                              ^\n");
    CHECK(
        problems("fluidcarve: 1\nnodes:\n  n: {type: toy.count, path: a.##}\n  m: {type: toy.add, numbers: n.nmber}\n") ==
        "p.yaml:4:31: 'n' (toy.count) has no output 'nmber'; did you mean 'number'?\n  m: {type: toy.add, numbers: n.nmber}\n                              ^\n"
        "p.yaml:3:3: it stands here\n  n: {type: toy.count, path: a.##}\n  ^\n");
}

TEST_CASE("missing inputs and parameters are named with what they take") {
    CHECK(problems("fluidcarve: 1\nnodes:\n  n: {type: toy.count}\n  m: {type: toy.add}\n") ==
          "p.yaml:3:3: toy.count needs 'path': a path\n  n: {type: toy.count}\n  ^\n"
          "p.yaml:4:3: toy.add needs its input 'numbers' (number)\n  m: {type: toy.add}\n  ^\n");
}

TEST_CASE("values of the wrong kind or out of range are refused at their place") {
    const auto with = [](const std::string& value) {
        return problems("fluidcarve: 1\nnodes:\n  n: {type: toy.count, path: a.##}\n  m:\n    type: toy.add\n    numbers: n\n    offset: " + value + "\n");
    };
    CHECK(with("fast") == "p.yaml:7:13: toy.add parameter 'offset' wants a number, not 'fast'\n    offset: fast\n            ^\n");
    CHECK(with("500") == "p.yaml:7:13: toy.add parameter 'offset' must be from -100 to 100, not 500\n    offset: 500\n            ^\n");
    CHECK(with(".nan") == "p.yaml:7:13: toy.add parameter 'offset' wants a number, not '.nan'\n    offset: .nan\n            ^\n");
    CHECK(with("[1, 2]") == "p.yaml:7:13: toy.add parameter 'offset' wants a number, not a list of 2\n    offset: [1, 2]\n            ^\n");
    CHECK(with("\n  k: {type: toy.add, numbers: n}") == "p.yaml:7:5: toy.add field 'offset' has no value\n    offset: \n    ^\n");
}

TEST_CASE("writers need a frame token exactly where they run per frame, and never write over an input or each other") {
    CHECK(problems("fluidcarve: 1\nnodes:\n  n: {type: toy.count, path: a.##}\n  p: {type: toy.print, number: n, path: out}\n") ==
          "p.yaml:4:41: toy.print writes a file for every frame: 'path' needs a frame token such as ####\n  p: {type: toy.print, number: n, path: out}\n"
          "                                        ^\n");
    CHECK(problems("fluidcarve: 1\nnodes:\n  n: {type: toy.count, path: a}\n  p: {type: toy.print, number: n, path: out.##}\n") ==
          "p.yaml:4:41: toy.print writes one file here, not one per frame: 'path' can't have a frame token\n  p: {type: toy.print, number: n, path: out.##}\n"
          "                                        ^\n");
    CHECK(problems("fluidcarve: 1\nnodes:\n  n: {type: toy.count, path: /a/b.##}\n  p: {type: toy.print, number: n, path: /a/./b.%02d}\n") ==
          "p.yaml:4:41: 'p' would overwrite a file of the same pipeline\n  p: {type: toy.print, number: n, path: /a/./b.%02d}\n                                "
          "        ^\n"
          "p.yaml:3:30: 'n' reads it here\n  n: {type: toy.count, path: /a/b.##}\n                             ^\n");
}

TEST_CASE("a later frame of a pattern is not written over either") {
    CHECK_THAT(problems("fluidcarve: 1\nframes: 1-9\nnodes:\n  n: {type: toy.count, path: /a/b.07}\n  c: {type: toy.count, path: /a/c.##}\n  p: {type: "
                        "toy.print, number: c, path: /a/b.##}\n"),
               Catch::Contains("'p' would overwrite a file of the same pipeline") && Catch::Contains("'n' reads it here"));
}

TEST_CASE("a faulty reader does not make its writer look faulty too") {
    CHECK(problems("fluidcarve: 1\nnodes:\n  n: {type: toy.count, path: a.##, late: maybe}\n  p: {type: toy.print, number: n, path: out.##}\n") ==
          "p.yaml:3:42: toy.count parameter 'late' wants true or false, not 'maybe'\n  n: {type: toy.count, path: a.##, late: maybe}\n"
          "                                         ^\n");
}

TEST_CASE("very many problems are cut short, and so is a long list of names") {
    std::string yaml = "fluidcarve: 1\nnodes:\n  n: {type: toy.count, path: a.##}\n";
    for (int n = 0; n < 150; ++n) yaml += fmt::format("  node{0}: {{type: toy.add, numbers: zzzzzzzzzzzz}}\n", n);
    const auto text = problems(yaml);
    CHECK_THAT(text, Catch::Contains("and 139 more\n") && Catch::EndsWith("... and 50 more problems\n"));
}

TEST_CASE("the frame set is checked where it stands") {
    CHECK_THAT(problems("fluidcarve: 1\nframes: 10-x\nnodes:\n  n: {type: toy.count, path: a.##}\n"), Catch::StartsWith("p.yaml:2:9: frames: "));
}

TEST_CASE("settings reach params and node fields, and are checked like the file") {
    const auto [pipeline, text] = check(Scratch(), good, {"by=7", "count.late=true", "total.only_place=2"});
    REQUIRE(text == "");
    CHECK(static_cast<const toy::Add::Params*>(pipeline.find("more")->params.get())->offset == 7);
    CHECK(static_cast<const toy::Count::Params*>(pipeline.find("count")->params.get())->late);
    CHECK(problems(good, {"bye=7"}) == "--set:1:1: there is no param 'bye'; did you mean 'by'?\nbye=7\n^\n");
    CHECK(problems(good, {"cuont.late=true"}) == "--set:1:1: there is no node 'cuont'; did you mean 'count'?\ncuont.late=true\n^\n");
    CHECK(problems(good, {"count.lat=true"}) == "--set:1:7: toy.count has no parameter 'lat'; did you mean 'late'?\ncount.lat=true\n      ^\n");
    CHECK(problems(good, {"by=70"}) == "--set:1:4: param 'by' must be from 0 to 10, not 70\nby=70\n   ^\n");
    CHECK(problems(good, {"by"}) == "--set:1:1: wants NODE.FIELD=VALUE or PARAM=VALUE\nby\n^\n");
}
