#include "graph/pipeline.h"
#include "graph/build_pipeline.h"
#include "graph/types/node_type.h"
#include "tests/graph/pipeline_cases.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

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

TEST_CASE(
    "an input takes a part of a node's first output by its name, if the output's type has parts") {
    Registry registry = toy::registry();
    registry.add(
        selection<toy::Number, toy::Number>([](const toy::Number& number, const std::string&) {
            return std::make_shared<toy::Number>(number.value / 2);
        }));
    const Scratch scratch;
    Problems found;
    const auto file = scratch.write("p.yaml", R"(fluidcarve: 1
nodes:
  count: {type: toy.count, path: in.txt}
  more: {type: toy.add, numbers: [count, count.number, count.half.way]}
)");
    const auto pipeline = build_pipeline(read_document(file, {}, found), registry, found);
    REQUIRE(to_text(found) == "");
    std::vector<std::string> taken, parts;
    for (const auto& link : pipeline.find("more")->inputs[0]) {
        taken.push_back(taken_by(pipeline, link));
        parts.push_back(link.part);
    }
    CHECK(taken == std::vector<std::string>{"number", "number", "half.way"});
    CHECK(parts == std::vector<std::string>{"", "", "half.way"});

    auto type = *registry.node("toy.add");
    type.name = "toy.passing";
    type.names_from = "numbre";
    CHECK_THROWS_WITH(
        registry.add(type),
        "node type 'toy.passing': its first output can't have the names of the grids of 'numbre': "
        "there is no such input");
    type.names_from = "numbers";
    type.outputs.clear();
    CHECK_THROWS_WITH(registry.add(type),
                      "node type 'toy.passing': it has no output that could have the names of the "
                      "grids of 'numbers'");
}

TEST_CASE("check warns of a node whose outputs no node takes, if another one writes") {
    const Scratch scratch;
    CHECK(warnings_of(check(scratch, good).pipeline).empty());
    const auto idle = good + "  idle: {type: toy.add, numbers: count}\n";
    CHECK_THAT(
        to_text(warnings_of(check(scratch, idle).pipeline)),
        Catch::Contains("p.yaml:11:3: warning: 'idle' (toy.add) runs, although no node takes "
                        "its outputs: connect it, or leave it out\n"));
    const auto tried = good.substr(0, good.find("  print:"));
    CHECK(warnings_of(check(scratch, tried).pipeline).empty());
}

TEST_CASE(
    "a node that gathers gives one result for all frames, or one per frame, as its traits and its "
    "inputs say") {
    Registry registry = toy::registry();
    auto type = *registry.node("toy.share");
    type.name = "toy.own";
    type.traits = [](const void* params) {
        return NodeTraits{.animates = static_cast<const toy::Share::Params*>(params)->stated};
    };
    registry.add(type);
    type = *registry.node("toy.add");
    type.name = "toy.adds";
    type.gathers = true;
    registry.add(type);
    type.name = "toy.sums";
    type.inputs[0].summed = true;
    registry.add(type);
    Problems found;
    const auto pipeline = build_pipeline(read_document(Scratch().write("p.yaml", R"(fluidcarve: 1
frames: 1-3
nodes:
  count: {type: toy.count, path: in.##.txt}
  still: {type: toy.count, path: in.txt}
  one: {type: toy.own, number: count}
  each: {type: toy.own, number: count, stated: true}
  fixed: {type: toy.own, number: still, stated: true}
  differs: {type: toy.adds, numbers: [count]}
  summed: {type: toy.sums, numbers: [count]}
)"),
                                                       {}, found),
                                         registry, found);
    REQUIRE(to_text(found) == "");
    CHECK(pipeline.find("one")->rate == Rate::sequence);
    CHECK(pipeline.find("each")->rate == Rate::frame);
    CHECK(pipeline.find("differs")->rate == Rate::frame);
    CHECK(pipeline.find("summed")->rate == Rate::sequence);
    CHECK(pipeline.find("summed")->per_frame_input);
    // Nothing that it gathers tells the frames apart.
    CHECK(pipeline.find("fixed")->rate == Rate::fixed);
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
    CHECK(to_text(problems) ==
          path +
              ":7:22: toy.add input 'numbers' takes number, but words.text is text\n"
              "    numbers: [count, words]\n"
              "                     ^\n" +
              path +
              ":4:3: 'words' (toy.speak) is defined here\n"
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
          "p.yaml:3:13: there is no node type 'toy.cuont'; did you mean 'toy.count'?\n  n: {type: "
          "toy.cuont, path: a.##}\n            ^\n");
    CHECK(problems("fluidcarve: 1\nnodes:\n  n: {type: toy.subtract}\n") ==
          "p.yaml:3:13: there is no node type 'toy.subtract'; known: toy.add, toy.count, toy.load, "
          "toy.print, toy.save, toy.share, toy.square, toy.top, "
          "toy.total\n  n: {type: toy.subtract}\n          "
          "  ^\n");
    CHECK(problems("fluidcarve: 1\nnodes:\n  n: {type: energy}\n") ==
          "p.yaml:3:13: there is no node type 'energy'; `fluidcarve nodes` lists them\n  n: {type: "
          "energy}\n            ^\n");
    CHECK(problems("fluidcarve: 1\nnodes:\n  count: {type: toy.count, path: a.##}\n  m: {type: "
                   "toy.add, numbers: cuont}\n") ==
          "p.yaml:4:31: there is no node 'cuont'; did you mean 'count'?\n  m: {type: toy.add, "
          "numbers: cuont}\n                              ^\n");
    CHECK(problems("fluidcarve: 1\nnodes:\n  n: {type: toy.count, path: a.##}\n  m: {type: "
                   "toy.add, numbers: n.nmber}\n") ==
          "p.yaml:4:31: 'n' (toy.count) has no output 'nmber'; did you mean 'number'?\n  m: {type: "
          "toy.add, numbers: n.nmber}\n                              ^\n"
          "p.yaml:3:3: it is defined here\n  n: {type: toy.count, path: a.##}\n  ^\n");
}

TEST_CASE("missing inputs and parameters are named with what they take") {
    CHECK(problems("fluidcarve: 1\nnodes:\n  n: {type: toy.count}\n  m: {type: toy.add}\n") ==
          "p.yaml:3:3: toy.count needs 'path': a path\n  n: {type: toy.count}\n  ^\n"
          "p.yaml:4:3: toy.add needs its input 'numbers' (number)\n  m: {type: toy.add}\n  ^\n");
}

TEST_CASE("values of the wrong kind or out of range are refused at their place") {
    const auto with = [](const std::string& value) {
        return problems(
            "fluidcarve: 1\nnodes:\n  n: {type: toy.count, path: a.##}\n  m:\n    type: toy.add\n  "
            "  numbers: n\n    offset: " +
            value + "\n");
    };
    for (const std::string bad : {"nan", "inf", "-.inf", "1e999", "-1e999", ".5.", "0x10", "1_000",
                                  "+-5", "++5", "1 2", "true"})
        CHECK(with(bad) == "p.yaml:7:13: toy.add parameter 'offset' must be a number, not '" + bad +
                               "'\n    offset: " + bad + "\n            ^\n");
    CHECK(with("\"\"") ==
          "p.yaml:7:13: toy.add parameter 'offset' must be a number, not ''\n    offset: \"\"\n    "
          "        ^\n");
    for (const std::string good : {"+5", "-5", ".5", "5.", "1e1", "\"7\""}) CHECK(with(good) == "");
    CHECK(with("fast") ==
          "p.yaml:7:13: toy.add parameter 'offset' must be a number, not 'fast'\n    offset: "
          "fast\n            ^\n");
    CHECK(with("500") ==
          "p.yaml:7:13: toy.add parameter 'offset' must be from -100 to 100, not 500\n    offset: "
          "500\n            ^\n");
    CHECK(with(".nan") ==
          "p.yaml:7:13: toy.add parameter 'offset' must be a number, not '.nan'\n    offset: "
          ".nan\n            ^\n");
    CHECK(with("[1, 2]") ==
          "p.yaml:7:13: toy.add parameter 'offset' must be a number, not a list of 2\n    offset: "
          "[1, 2]\n            ^\n");
    CHECK(with("\n  k: {type: toy.add, numbers: n}") ==
          "p.yaml:7:5: toy.add field 'offset' has no value\n    offset: \n    ^\n");
}

TEST_CASE("a whole number is whole, and fits") {
    const auto with = [](const std::string& value) {
        return problems(
            "fluidcarve: 1\nnodes:\n  n:\n    type: toy.count\n    path: a.##\n    fail_at: " +
            value + "\n");
    };
    const auto refused = [](const std::string& value, const std::string& wanted) {
        return "p.yaml:6:14: toy.count parameter 'fail_at' must be " + wanted + ", not '" + value +
               "'\n    fail_at: " + value + "\n             ^\n";
    };
    for (const std::string bad : {"1.5", "one", "nan", "0x10", "1e999"})
        CHECK(with(bad) == refused(bad, "a whole number"));
    for (const std::string large : {"2147483648", "-1e10"})
        CHECK(with(large) == refused(large, "a whole number from -2147483647 to 2147483647"));
    for (const std::string good : {"2147483647", "1e3", "+7", "7.0"}) CHECK(with(good) == "");
}

TEST_CASE("a number that a float can't hold is refused, not taken for infinite") {
    Problems problems;
    ValueReader reader(problems, "gain", any_number());
    const auto parse = [&](const std::string& text) {
        return ParamTraits<float>::parse(Value::scalar({}, text), reader);
    };
    CHECK(parse("-3.4e38") == -3.4e38f);
    CHECK_FALSE(parse("1e39"));
    CHECK(to_text(problems) == "gain must be a number up to 3.4e38, not '1e39'\n");
}
