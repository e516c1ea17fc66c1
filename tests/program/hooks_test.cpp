#include "tests/support/program.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

// What a plugin's author sees if a node's function has the name of a hook, but not its signature.

namespace {

/// What the compiler says of a node with this member.
std::string compiled(const std::string& member) {
    const Scratch scratch;
    const auto file = scratch.write("node.cpp", R"(#include "graph/types/node_type.h"
struct Node {
    struct Ports { fluidcarve::Ref<int> number; };
    void add(const fluidcarve::detail::NoParams&, const Ports&, fluidcarve::Context&) {}
    void finish(const fluidcarve::detail::NoParams&, Ports&, fluidcarve::Context&) {}
    )" + member + R"(
};
fluidcarve::NodeType node() { return fluidcarve::Declare<Node>("toy.node", "A node.").output("number", &Node::Ports::number, "A number."); }
)");
    return call_shell("c++ -std=c++20 -fsyntax-only -DFLUIDCARVE_VERSION='\"0\"' -I " SOURCE_ROOT
                      " " +
                      file + " 2>&1")
        .out;
}

}  // namespace

TEST_CASE("a hook of the wrong signature does not compile, and the compiler says what it must be",
          "[nightly][long]") {
    CHECK(compiled("void resume(const fluidcarve::Payload&, const nlohmann::ordered_json&) {}") ==
          "");
    CHECK_THAT(compiled("void resume(int) {}"),
               Catch::Contains("`resume` must be `void resume(const Payload& result, const "
                               "nlohmann::ordered_json& entry)`"));
    CHECK_THAT(compiled("static bool traits(int) { return true; }"),
               Catch::Contains("`traits` must be `static NodeTraits traits(const Params&)`"));
    CHECK_THAT(compiled("static void survey() {}"),
               Catch::Contains("`survey` must be `static void survey(const Params&, Survey&)`"));
    CHECK_THAT(compiled("static void foresee() {}"),
               Catch::Contains("`foresee` must be `static void foresee(const Params&, Outlook&)`"));
    CHECK_THAT(compiled("static void conclude(int) {}"),
               Catch::Contains("`conclude` must be `static void conclude(const Params&, const "
                               "nlohmann::ordered_json& frames, Context&)`"));
    CHECK_THAT(compiled("static int digest(int) { return 0; }"),
               Catch::Contains("`digest` must be `static std::shared_ptr<T> digest("));
}
