#include "graph/node_kinds.h"

#include "graph/document.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

#include <string>

using namespace fluidcarve;

namespace {

/// Gives back a number, or a text.
template <class T>
struct Same {
    struct Ports {
        Ref<T> in, out;
    };
    static void run(const auto&, Ports& io, Context&) { io.out = io.in; }
};

template <class T>
Declare<Same<T>> same(const std::string& name) {
    return Declare<Same<T>>(name, "The same.")
        .input("in", &Same<T>::Ports::in, "What goes in.")
        .output("out", &Same<T>::Ports::out, "What went in.");
}

/// Name of the type that the node `it` has.
std::string type_of_it(const std::string& nodes) {
    auto registry = toy::registry();
    registry.add(same<toy::Number>("toy.same").kind<toy::Text>("in", "toy.same_text"));
    registry.add(same<toy::Text>("toy.same_text"));
    registry.add(same<toy::Text>("toy.words"));
    const Scratch scratch;
    Problems problems;
    const auto document =
        read_document(scratch.write("p.yaml", "fluidcarve: 1\nnodes:\n" + nodes), {}, problems);
    const auto* const type = type_of(document.nodes.find("it")->value, document, registry);
    return type ? type->name : "none";
}

}  // namespace

TEST_CASE("a node has the kind of its type that its input asks for, in any order of the nodes") {
    const std::string word = "  word: {type: toy.words, in: x}\n";
    CHECK(type_of_it(word + "  it: {type: toy.same, in: word}\n") == "toy.same_text");
    CHECK(type_of_it("  it: {type: toy.same, in: word.out}\n" + word) == "toy.same_text");
    CHECK(type_of_it("  it: {type: toy.same, in: far}\n  far: {type: toy.same, in: word}\n" +
                     word) == "toy.same_text");
    CHECK(type_of_it("  it: {type: toy.same, in: n}\n  n: {type: toy.count}\n") == "toy.same");
}

TEST_CASE("a node keeps the type that it names where nothing says what its input is") {
    CHECK(type_of_it("  it: {type: toy.same, in: nobody}\n") == "toy.same");
    CHECK(type_of_it("  it: {type: toy.same, in: it}\n") == "toy.same");
    CHECK(type_of_it("  it: {type: toy.same, in: [it]}\n") == "toy.same");
    CHECK(type_of_it("  it: {type: toy.same, in: word.other}\n  word: {type: toy.words}\n") ==
          "toy.same");
    CHECK(type_of_it("  it: {type: toy.unknown, in: it}\n") == "none");
}
