#include "graph/yaml_reader.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

namespace {

struct Read {
    Value value;
    std::string text;
};

Read read(const std::string& text) {
    Problems problems;
    auto value = read_yaml(std::make_shared<Source>(Source{"f.yaml", text, {}}), problems);
    return {std::move(value), to_text(problems)};
}

}  // namespace

TEST_CASE("values come with their places") {
    const auto out = read("a: 1\nb:\n  - x\n  - {c: 'y z'}\n").value;
    REQUIRE(out.kind == Value::Kind::map);
    CHECK(out.find("a")->value.text == "1");
    const auto& list = out.find("b")->value;
    REQUIRE(list.items.size() == 2);
    CHECK(list.items[1].find("c")->value.text == "y z");
    CHECK(list.items[1].find("c")->value.mark.line == 4);
    CHECK(list.items[1].find("c")->value.mark.column == 9);
}

TEST_CASE("an empty value stands at its own key, not at the next") {
    const auto out = read("a:\nb: 1\n").value;
    CHECK(out.find("a")->value.kind == Value::Kind::null);
    CHECK(out.find("a")->value.mark.line == 1);
}

TEST_CASE("a duplicate key names both places") {
    CHECK(read("a: 1\nb: 2\na: 3\n").text == "f.yaml:3:1: 'a' is stated twice\na: 3\n^\nf.yaml:1:1: first stated here\na: 1\n^\n");
}

TEST_CASE("an alias repeats its value") {
    const auto out = read("a: &x [1, 2]\nb: *x\n");
    CHECK(out.text == "");
    CHECK(out.value.find("b")->value.items.size() == 2);
}

TEST_CASE("an alias into itself is refused") {
    CHECK(read("a: &x [1, *x]\n").text == "f.yaml:1:11: an alias stands inside the value that it names\na: &x [1, *x]\n          ^\n");
}

TEST_CASE("an alias bomb is refused before it grows") {
    std::string bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n";
    for (int n = 1; n < 9; ++n) {
        const auto before = "*a" + std::to_string(n - 1);
        bomb += "a" + std::to_string(n) + ": &a" + std::to_string(n) + " [" + before;
        for (int m = 1; m < 9; ++m) bomb += ", " + before;
        bomb += "]\n";
    }
    CHECK_THAT(read(bomb).text, Catch::Contains("more than 100000 values, aliases followed: no pipeline needs that"));
}

TEST_CASE("deep nesting, a large file and broken YAML are refused") {
    CHECK_THAT(read(std::string(70, '[')).text, Catch::Contains("nested more than 64 levels deep"));
    CHECK(read(std::string((1 << 20) + 1, 'a')).text == "f.yaml: the file holds 1048577 bytes, more than 1 MiB: not a pipeline\n");
    CHECK(read("a: [1, 2\nb: 3\n").text == "f.yaml:2:2: not YAML: end of sequence flow not found\nb: 3\n ^\n");
    CHECK(read("? [a]\n: 1\n").text == "f.yaml:1:3: a name is wanted here, not a list of one\n? [a]\n  ^\n");
}

TEST_CASE("a second document is not passed over") {
    CHECK(read("a: 1\n---\nb: 2\n").text == "f.yaml: a second YAML document follows; a pipeline file holds one\n");
}
