#include "graph/provenance.h"
#include "graph/build_pipeline.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <map>

using namespace fluidcarve;

namespace {

const std::string base = R"(fluidcarve: 1
env: [FLUIDCARVE_TEST_DIR, FLUIDCARVE_TEST_BY]
params:
  from: {type: path, default: in.####.txt}
  by: {type: float, default: 2.5}
  FLUIDCARVE_TEST_BY: {type: float, default: 0}
  out: {type: path, default: out.####.txt}
frames: 1-4
nodes:
  count: {type: toy.count, path: "${from}", fail_at: -1}
  more: {type: toy.add, numbers: [count, count.number], offset: "${by}", doc: A note., cache: false}
  again: {type: toy.add, numbers: more, offset: "${FLUIDCARVE_TEST_BY}"}
  print: {type: toy.print, number: again, path: "${out}"}
  beside: {type: toy.print, number: count, path: beside.####.txt}
)";

struct Stated {
    Pipeline pipeline;
    std::string problems;

    std::map<std::string, std::string> of(const std::string& writer) const {
        const auto& all = pipeline.find(writer)->provenance;
        return {all.begin(), all.end()};
    }
    std::string values(const std::string& writer = "print") const {
        return of(writer)["fluidcarve_values"];
    }
    std::string command(const std::string& writer = "print") const {
        return of(writer)["fluidcarve_command"];
    }
};

Stated state(const std::string& yaml, const std::vector<std::string>& settings = {}) {
    static const Registry registry = toy::registry();
    const Scratch scratch;
    Problems problems;
    const auto document = read_document(scratch.write("p.yaml", yaml), settings, problems);
    Stated out{build_pipeline(document, registry, problems), to_text(problems)};
    if (problems.empty()) state_provenance(out.pipeline, document, registry);
    for (std::size_t at; (at = out.problems.find(scratch.path() + "/")) != std::string::npos;)
        out.problems.erase(at, scratch.path().size() + 1);
    return out;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
}

}  // namespace

TEST_CASE(
    "a writer states version, pipeline, the values upstream that are not the declarations', and "
    "the command that makes its files again") {
    const auto stated = state(base);
    REQUIRE(stated.problems == "");
    CHECK(stated.pipeline.find("print")->provenance ==
          Provenance{{"fluidcarve_version", FLUIDCARVE_VERSION},
                     {"fluidcarve_pipeline", "p.yaml"},
                     {"fluidcarve_values",
                      "{fluidcarve: 1, frames: 1-4, nodes: {count: {type: toy.count, path: "
                      "in.####.txt}, more: {type: toy.add, numbers: [count, "
                      "count.number], offset: 2.5}, again: {type: toy.add, numbers: more}, print: "
                      "{type: toy.print, number: again}}}"},
                     {"fluidcarve_command", "fluidcarve run p.yaml"}});
    CHECK(stated.values("beside") ==
          "{fluidcarve: 1, frames: 1-4, nodes: {count: {type: toy.count, path: in.####.txt}, "
          "beside: {type: toy.print, number: count}}}");
    CHECK(stated.pipeline.find("more")->provenance.empty());
}

TEST_CASE("what a writer states changes with the values upstream of it and with nothing else") {
    const auto stated = state(base);
    const auto same = [&](const Stated& other) {
        CHECK(other.problems == "");
        CHECK(other.of("print") == stated.of("print"));
        CHECK(other.of("beside") == stated.of("beside"));
    };
    same(state(base, {"out=elsewhere/o.####.txt", "beside.path=/machine/b.####.txt"}));
    same(state("# A comment.\n" + replaced(base, "A note.", "Another.")));
    same(state(replaced(base, "fail_at: -1", "late: false")));
    same(state(base + "  third: {type: toy.print, number: count, path: third.####.txt}\n"));
    const auto other = state(base, {"by=3"});
    CHECK(other.of("beside") == stated.of("beside"));
    CHECK(other.values() == replaced(stated.values(), "offset: 2.5", "offset: 3"));
    CHECK(other.command() == "fluidcarve run p.yaml --set by=3");
    CHECK(state(base, {"frames=1-2"}).command("beside") ==
          "fluidcarve run p.yaml --set frames=1-2");
    CHECK(state(base, {"frames=1-2"}).values("beside") ==
          replaced(stated.values("beside"), "1-4", "\"1,2\""));
}

TEST_CASE("the command sets what the command line and the environment set, and names no variable") {
    setenv("FLUIDCARVE_TEST_BY", "7", 1);
    setenv("FLUIDCARVE_TEST_DIR", "caches", 1);
    CHECK(state(base).command() == "fluidcarve run p.yaml --set FLUIDCARVE_TEST_BY=7");
    CHECK(state(base).command("beside") == "fluidcarve run p.yaml");
    const auto inside =
        state(replaced(base, "\"${from}\"", "\"${FLUIDCARVE_TEST_DIR}/in.####.txt\""));
    CHECK(inside.command("beside") == "fluidcarve run p.yaml --set count.path=caches/in.####.txt");
    const auto in_default = state(
        replaced(base, "default: in.####.txt", "default: \"${FLUIDCARVE_TEST_DIR}/in.####.txt\""));
    CHECK(in_default.command("beside") == "fluidcarve run p.yaml --set from=caches/in.####.txt");
    unsetenv("FLUIDCARVE_TEST_BY");
    unsetenv("FLUIDCARVE_TEST_DIR");
    CHECK(state(base, {"by=3", "more.numbers=[count]", "count.late=true"}).command() ==
          "fluidcarve run p.yaml --set by=3 --set count.late=true --set 'more.numbers=[count]'");
}

TEST_CASE("an absolute path is cut to the file's name, wherever it comes from") {
    const auto values = state(base).values("beside");
    const auto by_param = state(base, {"from=/machine/in.####.txt"});
    CHECK(by_param.values("beside") == values);
    CHECK(by_param.command("beside") == "fluidcarve run p.yaml --set from=in.####.txt");
    CHECK(state(base, {"count.path=/machine/in.####.txt"}).command("beside") ==
          "fluidcarve run p.yaml --set count.path=in.####.txt");
    const auto in_file =
        state(replaced(base, "default: in.####.txt", "default: /machine/in.####.txt"));
    CHECK(in_file.values("beside") == values);
    CHECK(in_file.command("beside") == "fluidcarve run p.yaml");
    setenv("FLUIDCARVE_TEST_DIR", "/machine", 1);
    const auto inside =
        state(replaced(base, "\"${from}\"", "\"${FLUIDCARVE_TEST_DIR}/in.####.txt\""));
    unsetenv("FLUIDCARVE_TEST_DIR");
    CHECK(inside.values("beside") == values);
    CHECK(inside.command("beside") == "fluidcarve run p.yaml --set count.path=in.####.txt");
}

TEST_CASE("all that is stated is a line of ASCII, and the command is one for a shell") {
    const auto stated = state(base, {"count.path=caf\xc3\xa9's/in.####.txt"});
    CHECK_THAT(stated.values("beside"), Catch::Contains(R"(path: "caf\u00e9's/in.####.txt")"));
    CHECK(stated.command("beside") ==
          R"(fluidcarve run p.yaml --set $'count.path=caf\xc3\xa9\'s/in.####.txt')");
    CHECK(state(base, {"count.path=two words/it's.####.txt"}).command("beside") ==
          R"(fluidcarve run p.yaml --set 'count.path=two words/it'\''s.####.txt')");
}

TEST_CASE("values too long for a file are not stated") {
    std::string numbers = "count";
    for (int n = 0; n < 10000; ++n) numbers += ", count";
    const auto stated = state(replaced(base, "count, count.number", numbers));
    CHECK(stated.problems == "");
    CHECK_THAT(stated.values(), Catch::Matches("7[0-9]{4} bytes, too long to be stated"));
    CHECK(stated.command() == "fluidcarve run p.yaml");
}

TEST_CASE("a pipeline may say that its files state nothing") {
    const auto off = state("provenance: false\n" + base);
    CHECK_FALSE(off.pipeline.provenance);
    CHECK(off.pipeline.find("print")->provenance.empty());
    CHECK(state("provenance: true\n" + base).of("print") == state(base).of("print"));
    CHECK(state("provenance: maybe\n" + base).problems ==
          "p.yaml:1:13: 'provenance' must be true or false, not 'maybe'\nprovenance: maybe\n       "
          "     ^\n");
}
