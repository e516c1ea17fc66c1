#include "graph/views/describe.h"
#include "graph/types/file_fields.h"
#include "graph/views/schema.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace fluidcarve;
using Json = nlohmann::ordered_json;

namespace {

enum class Mode { soft, hard };

}  // namespace

template <>
struct fluidcarve::ChoiceNames<Mode> {
    static constexpr std::array names = {std::pair{"soft", Mode::soft},
                                         std::pair{"hard", Mode::hard}};
};

namespace {

struct Water {};
struct Stone {};

struct Well {
    struct Params {
        InputPath path;
    };
    struct Ports {
        Ref<Water> water;
        NamedOutputs more;
    };
    static void run(const Params&, Ports&, Context&) {}
};

struct Mix {
    struct Params {
        double gain = 1.5;
        Auto<Interval> range;
        Mode mode = Mode::hard;
        Vec3 up{0, 0, 1};
        std::string note;
        Count count;
    };
    struct Ports {
        List<Water> terms;
        Optional<Stone> mask;
        Named<Water> inputs;
        Ref<Water> out;
    };
    static void run(const Params&, Ports&, Context&) {}
};

struct Dam {
    struct Ports {
        Ref<Water> water;
        Ref<Stone> wall;
    };
    void add(const detail::NoParams&, const Ports&, Context&) {}
    void finish(const detail::NoParams&, Ports&, Context&) {}
};

Registry toys() {
    Registry out;
    out.add(payload_type<Water>("water", "Wet.", [](const Water&) { return 1; }));
    out.add(payload_type<Stone>("stone", "Hard.", [](const Stone&) { return 1; }));
    out.add(conversion<Water, Stone>(
        [](const Ref<Water>&) { return std::make_shared<const Stone>(); }));
    out.add(NodeType(Declare<Well>("source.well", "Water from the ground. It may run dry.")
                         .required("path", &Well::Params::path, "Where the well is.")
                         .output("water", &Well::Ports::water, "Clear water.")
                         .outputs_from("path", &Well::Ports::more, [](const Well::Params&) {
                             return std::vector<std::pair<std::string, std::type_index>>();
                         })));
    out.add(
        NodeType(Declare<Mix>("water.mix", "Several waters in one.")
                     .input("terms", &Mix::Ports::terms, "What is mixed.")
                     .input("mask", &Mix::Ports::mask, "Where it is mixed.")
                     .input("inputs", &Mix::Ports::inputs, "Waters with names.")
                     .param("gain", &Mix::Params::gain, Unit::world, between(0, 4),
                            "Multiplier on the result.")
                     .param("range", &Mix::Params::range, "Of the result.")
                     .param("mode", &Mix::Params::mode, "How it is mixed; a | b.")
                     .param("up", &Mix::Params::up, "Away from the ground.")
                     .param("note", &Mix::Params::note, "For people.")
                     .required("count", &Mix::Params::count, Unit::seams, any_number(), "How many.")
                     .output("out", &Mix::Ports::out, "The mixture.")));
    out.add(NodeType(Declare<Dam>("water.dam", "Holds all water back.")
                         .input("water", &Dam::Ports::water, "Water.")
                         .output("wall", &Dam::Ports::wall, "The wall.")));
    return out;
}

}  // namespace

TEST_CASE("the listing groups node types by family and gives each a line") {
    CHECK(listing(toys()) ==
          "source\n"
          "  source.well  Water from the ground.\n"
          "\n"
          "water\n"
          "  water.dam    Holds all water back.\n"
          "  water.mix    Several waters in one.\n");
}

TEST_CASE("a node type's description tells all that its declaration says") {
    const auto registry = toys();
    CHECK(describe(registry, *registry.node("water.mix")) == R"(water.mix
  Several waters in one.

inputs
  terms: one or a list, each water
      What is mixed.
  mask: stone or water; optional
      Where it is mixed.
  inputs: {name: node, ...}, each water
      Waters with names.

parameters
  gain: a number; world units; from 0 to 4; default 1.5
      Multiplier on the result.
  range: auto or [low, high]; default auto
      Of the result.
  mode: one of soft, hard; default hard
      How it is mixed; a | b.
  up: [x, y, z]; default [0, 0, 1]
      Away from the ground.
  note: a text; default empty
      For people.
  count: a whole number of seams or a percentage such as -10%; seams; required
      How many.

outputs
  out: water
      The mixture.

example
  mix:
    type: water.mix
    terms: [a, b]         # node or node.output: water
    inputs: {a: a, b: b}  # node or node.output: water
    count: -12            # a whole number of seams or a percentage such as -10%
)");
}

TEST_CASE("outputs that come once and outputs that a parameter names are told") {
    const auto registry = toys();
    CHECK_THAT(describe(registry, *registry.node("water.dam")),
               Catch::Contains("wall: stone; once for the whole sequence"));
    CHECK_THAT(describe(registry, *registry.node("source.well")),
               Catch::Contains(
                   "One more output for each entry of 'path', with the entry's name and type."));
}

TEST_CASE("long docs are wrapped") {
    auto registry = toys();
    NodeType type = *registry.node("water.dam");
    type.doc.clear();
    for (int n = 0; n < 60; ++n) type.doc += (n ? " " : "") + std::string("word");
    const auto text = describe(registry, type);
    std::size_t begin = 0;
    for (auto end = text.find('\n'); end != std::string::npos;
         begin = end + 1, end = text.find('\n', begin))
        CHECK(end - begin <= 100);
    CHECK_THAT(text, Catch::Contains("word word\n  word word"));
}

TEST_CASE("the Markdown reference has every node, port, parameter and travelling type") {
    const auto text = to_markdown(toys());
    for (const auto* part :
         {"## water\n", "### water.mix\n", "- [water](#water)",
          "  - [water.mix](#watermix): Several waters in one.",
          "| `terms` | one or a list, each water | What is mixed. |",
          "| `gain` | a number, from 0 to 4 | world units | `1.5` | Multiplier on the result. |",
          "| `mode` | one of soft, hard |   | `hard` | How it is mixed; a \\| b. |",
          "| `count` | a whole number of seams or a percentage such as -10% | seams | required | "
          "How many. |",
          "| `wall` | stone; once for the whole sequence | The wall. |", "| stone | Hard. |",
          "```yaml\nwell:\n  type: source.well\n"})
        CHECK_THAT(text, Catch::Contains(part));
    CHECK_THAT(text, Catch::Contains(to_markdown(toys(), *toys().node("water.dam"))));
    for (const auto& field : common_fields)
        if (field.name != "type")
            CHECK_THAT(text.substr(0, text.find("## water")),
                       Catch::Contains("`" + std::string(field.name)));
}

TEST_CASE("the JSON reference has every field") {
    const auto all = to_json(toys());
    REQUIRE(all["nodes"].size() == 3);
    const auto& mix = all["nodes"][2];
    CHECK(mix["name"] == "water.mix");
    CHECK(
        mix["inputs"][1] ==
        Json::parse(
            R"({"name": "mask", "type": "stone", "accepts": ["water", "stone"], "arity": "optional", "doc": "Where it is mixed."})"));
    CHECK(
        mix["params"][0] ==
        Json::parse(
            R"({"name": "gain", "value": "a number", "unit": "world units", "min": 0.0, "max": 4.0, "default": "1.5", "doc": "Multiplier on the result."})"));
    CHECK(mix["params"][5]["required"] == true);
    CHECK(mix["params"][2]["choices"] == Json::parse(R"(["soft", "hard"])"));
    CHECK(all["nodes"][1]["outputs"][0]["once"] == true);
    CHECK(all["nodes"][0]["outputs_from"] == "path");
    CHECK(to_json(toys(), *toys().node("water.mix")) == mix);
    CHECK(all["types"][0] == Json::parse(R"({"name": "water", "doc": "Wet."})"));
}

TEST_CASE("the schema knows each node type's fields, forms and defaults") {
    const auto text = schema(toys());
    CHECK(text.back() == '\n');
    const auto all = Json::parse(text);
    CHECK(all["$schema"] == "http://json-schema.org/draft-07/schema#");
    CHECK(all["additionalProperties"] == false);
    CHECK(all["properties"]["fluidcarve"]["const"] == 1);
    const auto& definitions = all["definitions"];
    const auto& mix = definitions["water.mix"];
    CHECK(mix["additionalProperties"] == false);
    CHECK(mix["properties"].size() == 12);
    CHECK(mix["properties"]["gain"]["default"] == 1.5);
    CHECK(mix["properties"]["gain"]["description"] ==
          "Multiplier on the result. Unit: world units. Default: 1.5.");
    CHECK(mix["properties"]["gain"]["anyOf"][0]["anyOf"][0] ==
          Json::parse(R"({"type": "number", "minimum": 0.0, "maximum": 4.0})"));
    CHECK(mix["properties"]["up"]["default"] == Json::parse("[0, 0, 1]"));
    CHECK(mix["properties"]["range"]["default"] == "auto");
    CHECK_FALSE(mix["properties"]["count"].contains("default"));
    CHECK(mix["properties"]["mask"]["description"] == "Where it is mixed. Takes stone or water.");
    CHECK(definitions["node"]["properties"]["type"]["enum"] ==
          Json::parse(R"(["source.well", "water.dam", "water.mix"])"));
    CHECK(definitions["node"]["allOf"][2]["then"]["allOf"][1]["required"] ==
          Json::parse(R"(["type", "terms", "inputs", "count"])"));
    CHECK_FALSE(definitions["node_change"].contains("required"));
}

TEST_CASE("every reference inside the schema leads to a definition") {
    const auto all = Json::parse(schema(toys()));
    std::size_t seen = 0;
    const auto walk = [&](auto&& self, const Json& value) -> void {
        if (value.is_object() && value.contains("$ref") && value["$ref"].is_string()) {
            const auto target = value["$ref"].get<std::string>();
            INFO(target);
            REQUIRE(target.starts_with("#/"));
            CHECK(all.contains(Json::json_pointer(target.substr(1))));
            ++seen;
        }
        if (value.is_structured())
            for (const auto& each : value) self(self, each);
    };
    walk(walk, all);
    CHECK(seen > 20);
}
