#include "graph/text/yaml_reader.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

namespace {

struct ReadValue {
    Value value;
    std::string text;
};

ReadValue read(const std::string& text) {
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

TEST_CASE("a control character in a text is refused at its place, whatever escape makes it") {
    CHECK(read("a: 1\nb: {path: \"in.vdb\\0.obj\"}\n").text ==
          "f.yaml:2:11: the text holds the control character 0x00, which no name, path or program "
          "may: leave it out\nb: {path: \"in.vdb\\0.obj\"}\n          "
          "^\n");
    CHECK_THAT(read("\"a\\e[31m\": 1\n").text,
               Catch::StartsWith("f.yaml:1:1: the text holds the control character 0x1b"));
    CHECK(read("a: \"two\\n\\tlines\"\n").text == "");
}

TEST_CASE("an empty value stands at its own key, not at the next") {
    const auto out = read("a:\nb: 1\n").value;
    CHECK(out.find("a")->value.kind == Value::Kind::null);
    CHECK(out.find("a")->value.mark.line == 1);
}

TEST_CASE("a duplicate key names both places") {
    CHECK(read("a: 1\nb: 2\na: 3\n").text ==
          "f.yaml:3:1: 'a' is stated twice\na: 3\n^\nf.yaml:1:1: first stated here\na: 1\n^\n");
}

TEST_CASE("an alias repeats its value") {
    const auto out = read("a: &x [1, 2]\nb: *x\n");
    CHECK(out.text == "");
    CHECK(out.value.find("b")->value.items.size() == 2);
}

TEST_CASE("an alias of what is not there is refused") {
    // Newer versions of yaml-cpp name it, too.
    CHECK_THAT(read("a: [1, *x]\n").text,
               Catch::StartsWith("f.yaml:1:8: not YAML: the referenced anchor is not defined") &&
                   Catch::EndsWith("\na: [1, *x]\n       ^\n"));
}

TEST_CASE("an alias into itself is refused") {
    CHECK(read("a: &x {b: {c: [*x]}}\n").text ==
          "f.yaml:1:16: this alias is part of the value that it refers to\na: &x {b: {c: [*x]}}\n  "
          "             ^\n");
    CHECK(read("a: &x [1, *x]\n").text ==
          "f.yaml:1:11: this alias is part of the value that it refers to\na: &x [1, *x]\n         "
          " ^\n");
}

TEST_CASE("an alias bomb is refused before it grows") {
    std::string bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n";
    for (int n = 1; n < 9; ++n) {
        const auto before = "*a" + std::to_string(n - 1);
        bomb += "a" + std::to_string(n) + ": &a" + std::to_string(n) + " [" + before;
        for (int m = 1; m < 9; ++m) bomb += ", " + before;
        bomb += "]\n";
    }
    CHECK(read(bomb).text ==
          "f.yaml:6:10: more than 100000 values, with all aliases expanded: no pipeline needs so "
          "many\n"
          "a5: &a5 [*a4, *a4, *a4, *a4, *a4, *a4, *a4, *a4, *a4]\n"
          "         ^\n");
}

TEST_CASE("deep nesting, a large file and broken YAML are refused") {
    const auto nested = std::string(70, '[') + std::string(70, ']');
    CHECK(read(nested).text == "f.yaml:1:65: nested more than 64 levels deep\n" + nested + "\n" +
                                   std::string(64, ' ') + "^\n");
    CHECK(read(std::string((1 << 20) + 1, 'a')).text ==
          "f.yaml: the file holds more than 1 MiB: not a pipeline\n");
    CHECK(read("a: [1, 2\nb: 3\n").text ==
          "f.yaml:2:2: not YAML: end of sequence flow not found\nb: 3\n ^\n");
    CHECK(read("? [a]\n: 1\n").text ==
          "f.yaml:1:3: a name is wanted here, not a list of one\n? [a]\n  ^\n");
}

TEST_CASE("what would take a parser long, or deep, does not") {
    const auto many = [](const std::string& text) {
        std::string out;
        while (out.size() + text.size() <= 1 << 20) out += text;
        return read(out).text;
    };
    const auto deep = [&](const std::string& text) {
        const auto told = many(text);
        return told.substr(0, told.find('\n'));
    };
    CHECK(deep("[") == "f.yaml:1:33: nested more than 64 levels deep");
    CHECK(deep("{") == "f.yaml:1:64: nested more than 64 levels deep");
    CHECK(deep("- ") == "f.yaml:1:129: nested more than 64 levels deep");
    CHECK(deep("? ") == "f.yaml:1:129: nested more than 64 levels deep");
    CHECK(deep("[? ") == "f.yaml:1:95: nested more than 64 levels deep");
    CHECK(deep("&a ") == "f.yaml:1:4: not YAML: cannot assign multiple anchors to the same node");
    CHECK(deep("- a\n") ==
          "f.yaml:100000:3: more than 100000 values, with all aliases expanded: no pipeline needs "
          "so many");
    CHECK(many("#\n") == "");
}

TEST_CASE("binary data is refused, whatever its bytes") {
    for (const char byte : {'\0', '\1', '\x1b', '\f'})
        CHECK(read(std::string("a: ") + byte + "\n").text ==
              "f.yaml: binary data: a pipeline is a text in UTF-8\n");
    CHECK(read("a: \t1\r\nb: \"\xc3\xa9\"\r\n").text == "");
}

TEST_CASE("a second document is not passed over") {
    CHECK(read("a: 1\n---\nb: 2\n").text ==
          "f.yaml: a second YAML document follows; a pipeline file holds one\n");
}
