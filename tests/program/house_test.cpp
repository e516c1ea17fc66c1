#include "tests/support/program.h"

#include <catch2/catch.hpp>

// Includes go one way: nodes -> graph, runtime -> graph; only main joins nodes and runtime.

TEST_CASE("graph/ includes no volume, no task and no mesh library, and neither other wing") {
    CHECK(call_shell(R"(grep -nE '#include *[<"](openvdb|tbb|oneapi|OpenMesh|nodes/|runtime/)' graph/*)").out == "");
    CHECK(call_shell(R"(grep -lE 'yaml-cpp' graph/* | grep -v '^graph/yaml_reader.cpp$')").out == "");
}

TEST_CASE("nodes/ and runtime/ never include each other, but for main") {
    CHECK(call_shell(R"(grep -rnE '#include *"runtime/' nodes)").out == "");
    CHECK(call_shell(R"(grep -nE '#include *("nodes/|<openvdb)' runtime/* | grep -v '^runtime/main.cpp:')").out == "");
}

TEST_CASE("the algorithms of nodes/ know nothing of the graph but failures and frames") {
    CHECK(
        call_shell(
            R"(grep -rlE '#include "graph/(node_type|registry|pipeline|document|yaml_reader)' nodes --include=*.h | grep -vE 'nodes/(catalogue|precompiled)\.h' | while read f; do
        grep -q 'NodeType ' "$f" || grep -q 'Registry&' "$f" || grep -q 'Declare<' "$f" || grep -q 'FileInspector ' "$f" || echo "$f"; done)")
            .out == "");
}

TEST_CASE("no two wings give two types one name, which a linker would take for the same") {
    CHECK(
        call_shell(
            R"(grep -hoE '^(struct|class|enum class) +[A-Za-z_]+ *(:.*)?\{' --include=*.h -r graph runtime nodes | awk '{print $(/^enum/ ? 3 : 2)}' | tr -d ':{' | sort | uniq -d)")
            .out == "");
}
