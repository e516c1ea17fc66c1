#include "graph/views/drawing.h"
#include "graph/types/node_type.h"
#include "graph/views/layout.h"
#include "tests/support/files/well_formed.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <string>

using namespace fluidcarve;

namespace {

struct Drawn {};

Registry drawn_types() {
    Registry out;
    out.add(payload_type<Drawn>("water", "Wet.", [](const Drawn&) { return 1; }));
    return out;
}

NodeType toy_type(const std::string& name) {
    NodeType out;
    out.name = name;
    out.doc = "A <toy> & more.";
    out.inputs = {{"in", "In.", InputSpec::Arity::list, typeid(Drawn), {}, false}};
    out.outputs = {{"out", "Out.", typeid(Drawn), {}}};
    return out;
}

/// Nodes of one type; each pair of indices is a connection.
Pipeline chain(const NodeType& type, std::size_t size,
               const std::vector<std::pair<std::size_t, std::size_t>>& edges) {
    Pipeline out;
    out.name = "a<b>.yaml";
    for (std::size_t n = 0; n < size; ++n) {
        Node node;
        node.name = "n" + std::to_string(n);
        node.type = &type;
        node.outputs = type.outputs;
        node.inputs.resize(1);
        node.rate = n == 0 ? Rate::fixed : n == 1 ? Rate::frame : Rate::sequence;
        node.gathers = n == 2;
        out.nodes.push_back(std::move(node));
    }
    for (const auto& [from, to] : edges) out.nodes[to].inputs[0].push_back({from, 0});
    return out;
}

std::size_t count(const std::string& text, const std::string& what) {
    std::size_t out = 0;
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++out;
    return out;
}

}  // namespace

TEST_CASE("the picture is well-formed and has every node and connection") {
    const auto registry = drawn_types();
    const auto type = toy_type("water.mix");
    const auto svg = to_svg(chain(type, 4, {{0, 1}, {1, 2}, {0, 2}, {2, 3}, {0, 3}}), registry);
    CHECK(well_formed(svg));
    CHECK_FALSE(well_formed("<a><b></a></b>"));
    CHECK_FALSE(well_formed("<a>x & y</a>"));
    CHECK_FALSE(well_formed("<a>x < y</a>"));
    CHECK_FALSE(well_formed("<a><b></a>"));
    CHECK(count(svg, "<path class=\"edge\"") == 5);
    CHECK(count(svg, ">water.mix<") == 4);
    for (const auto* part :
         {">n0<", ">n3<", "n0.out (water) -&gt; n3.in", "<title>a&lt;b&gt;.yaml</title>",
          "A &lt;toy&gt; &amp; more.", "class=\"node static\"", "class=\"node frame\"",
          "class=\"node sequence\"", "static: once", "sequence: once, after all frames",
          "frame: for every frame", "gathers all frames"})
        CHECK_THAT(svg, Catch::Contains(part));
}

TEST_CASE("the legend explains only what the picture shows") {
    const auto type = toy_type("water.mix");
    const auto svg = to_svg(chain(type, 1, {}), drawn_types());
    CHECK_THAT(svg, Catch::Contains("static: once"));
    CHECK_THAT(svg, !Catch::Contains("sequence:") && !Catch::Contains("gathers"));
}

TEST_CASE("for a page each box has a class and a note of its own, and there is no legend") {
    const auto type = toy_type("water.mix");
    const auto svg = to_svg(chain(type, 3, {{0, 1}, {1, 2}}), drawn_types(),
                            {{"hot", "2 s"}, {"kept", "a < b"}, {"idle failed", "none"}});
    CHECK(well_formed(svg));
    for (const auto* part :
         {"<g class=\"node hot\">", "<g class=\"node kept\">", "<g class=\"node idle failed\">",
          ">2 s<", ">a &lt; b<", ">n2<", "style=\"--width:"})
        CHECK_THAT(svg, Catch::Contains(part));
    CHECK_THAT(svg, !Catch::Contains("for every frame") && !Catch::Contains("gathers all frames"));
}

TEST_CASE("Graphviz text has every node and connection") {
    const auto type = toy_type("water.mix");
    const auto dot = to_dot(chain(type, 3, {{0, 1}, {1, 2}, {0, 2}}), drawn_types());
    CHECK(count(dot, " -> \"n") == 3);
    for (const auto* part :
         {"digraph \"a<b>.yaml\" {\n",
          "\"n0\" [label=\"n0\\nwater.mix\", fillcolor=\"#d5dbe1\", penwidth=1", "penwidth=2.5",
          "    \"n0\" -> \"n2\" [tooltip=\"n0.out (water) -> n2.in\"];\n"})
        CHECK_THAT(dot, Catch::Contains(part));
}

TEST_CASE("boxes stand in columns, apart, with every edge pointing right") {
    Layout layout;
    for (int n = 0; n < 12; ++n) layout.boxes.push_back({80.0 + 5 * n, 40, 0, 0});
    for (const auto& [from, to] : std::vector<std::pair<std::size_t, std::size_t>>{{0, 2},
                                                                                   {1, 2},
                                                                                   {0, 3},
                                                                                   {2, 4},
                                                                                   {3, 4},
                                                                                   {0, 5},
                                                                                   {5, 6},
                                                                                   {4, 7},
                                                                                   {6, 7},
                                                                                   {7, 8},
                                                                                   {7, 9},
                                                                                   {0, 9},
                                                                                   {10, 9},
                                                                                   {4, 9}})
        layout.edges.push_back({std::min(from, to), std::max(from, to), {}});
    layout.place();
    CHECK(std::ranges::min_element(layout.boxes, [](const auto& a, const auto& b) {
              return a.y < b.y;
          })->y < 30);
    for (std::size_t a = 0; a < layout.boxes.size(); ++a) {
        const auto& one = layout.boxes[a];
        CHECK(one.x >= 0);
        CHECK(one.y >= -1e-9);
        CHECK(one.x + one.width <= layout.width + 1e-9);
        CHECK(one.y + one.height <= layout.height + 1e-9);
        for (std::size_t b = 0; b < a; ++b) {
            const auto& other = layout.boxes[b];
            CHECK((one.x + one.width < other.x || other.x + other.width < one.x ||
                   one.y + one.height < other.y || other.y + other.height < one.y));
        }
    }
    for (const auto& edge : layout.edges) {
        REQUIRE(edge.route.size() >= 2);
        const auto& from = layout.boxes[edge.from];
        const auto& to = layout.boxes[edge.to];
        CHECK(edge.route.front().x == Approx(from.x + from.width));
        CHECK(edge.route.back().x == Approx(to.x));
        CHECK(edge.route.back().y > to.y);
        CHECK(edge.route.back().y < to.y + to.height);
        for (std::size_t n = 1; n < edge.route.size(); ++n)
            CHECK(edge.route[n].x >= edge.route[n - 1].x);
    }
}

TEST_CASE("a crossing that can be undone is undone, and a chain is straight") {
    Layout crossed;
    crossed.boxes.assign(4, {50, 20, 0, 0});
    crossed.edges = {{0, 3, {}}, {1, 2, {}}};
    crossed.place();
    CHECK((crossed.boxes[0].y < crossed.boxes[1].y) == (crossed.boxes[3].y < crossed.boxes[2].y));

    Layout straight;
    straight.boxes.assign(3, {50, 20, 0, 0});
    straight.edges = {{0, 1, {}}, {1, 2, {}}};
    straight.place();
    CHECK(straight.boxes[0].y == Approx(straight.boxes[2].y));
    CHECK(straight.height == Approx(20));
    CHECK(straight.boxes[0].y == Approx(0).margin(1e-9));
}

TEST_CASE("an empty pipeline is a picture too") {
    CHECK(well_formed(to_svg(Pipeline(), drawn_types())));
}
