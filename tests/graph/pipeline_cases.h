#pragma once

#include "graph/build_pipeline.h"
#include "graph/pipeline.h"
#include "graph/types/node_type.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

struct Checked {
    Pipeline pipeline;
    std::string text;  ///< of all problems, the scratch folder cut from the names
};

inline Checked check(const Scratch& scratch, const std::string& yaml,
                     const std::vector<std::string>& settings = {}) {
    static const Registry registry = toy::registry();
    Problems problems;
    const auto document = read_document(scratch.write("p.yaml", yaml), settings, problems);
    Checked out{build_pipeline(document, registry, problems), to_text(problems)};
    for (std::size_t at; (at = out.text.find(scratch.path() + "/")) != std::string::npos;)
        out.text.erase(at, scratch.path().size() + 1);
    return out;
}

inline std::string problems(const std::string& yaml,
                            const std::vector<std::string>& settings = {}) {
    return check(Scratch(), yaml, settings).text;
}

inline const std::string good = R"(fluidcarve: 1
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
