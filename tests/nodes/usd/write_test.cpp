#include "nodes/usd.h"

#include "graph/build_pipeline.h"
#include "graph/pipeline.h"
#include "nodes/catalogue.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;
using Texts = std::vector<std::string>;

namespace {

/// What a check tells of a pipeline with these fields of usd.write.
Texts told(const std::string& fields) {
    static const auto registry = builtin_registry();
    const Scratch scratch;
    const auto file =
        scratch.write("p.yaml",
                      "fluidcarve: 1\n"
                      "frames: 1-3\n"
                      "nodes:\n"
                      "  sim:   {type: vdb.read, path: in.####.vdb}\n"
                      "  mesh:  {type: mesh.read, path: in.obj}\n"
                      "  smoke: {type: vdb.write, source: sim, path: out/s.####.vdb}\n"
                      "  bank:  {type: mesh.write, source: mesh, path: out/b.usda}\n"
                      "  sheet: {type: preview.sheet, before: sim, path: out/s.png}\n"
                      "  shot:  {type: usd.write, " +
                          fields + "}\n");
    Problems problems;
    build_pipeline(read_document(file, {}, problems), registry, problems);
    Texts out;
    for (const auto& problem : problems) out.push_back(problem.message);
    return out;
}

const std::string good =
    "path: out/shot.usda, volumes: {smoke: sim}, files: {smoke: out/s.####.vdb, bank: out/b.usda}";

}  // namespace

TEST_CASE("usd.write takes files that other nodes write, however their patterns are spelled") {
    CHECK(told(good).empty());
    CHECK(
        told("path: out/shot.usda, volumes: {smoke: sim}, files: {smoke: ./out/../out/s.%04d.vdb}")
            .empty());
    CHECK(told("path: out/shot.usda, files: {bank: out/b.usda}").empty());
}

TEST_CASE("usd.write refuses files that nobody writes") {
    CHECK(told("path: out/shot.usda, volumes: {smoke: sim}, files: {smoke: out/x.####.vdb}") ==
          Texts{"usd.write parameter 'files': no other node writes out/x.####.vdb; did you mean "
                "'out/s.####.vdb'?"});
    const auto own = told("path: out/shot.usda, files: {shot: out/shot.usda}");
    REQUIRE(own.size() == 1);
    CHECK_THAT(own[0], Catch::StartsWith(
                           "usd.write parameter 'files': no other node writes out/shot.usda; "));
    // What a node of an unknown type would write is not known.
    CHECK(told("path: out/shot.usda, files: {a: out/a.usda}}\n  other: {type: mesh.wirte, path: "
               "out/a.usda")
              .size() == 1);
    const auto width =
        told("path: out/shot.usda, volumes: {smoke: sim}, files: {smoke: out/s.##.vdb}");
    CHECK(width == Texts{"usd.write parameter 'files': no other node writes out/s.##.vdb; did you "
                         "mean 'out/s.####.vdb'?"});
}

TEST_CASE("usd.write says which volume lacks a file, and which file its volume") {
    CHECK(told("path: out/shot.usda, files: {smoke: out/s.####.vdb}") ==
          Texts{"usd.write needs what out/s.####.vdb holds: connect what its writer takes, as in "
                "'volumes: {smoke: NODE}'"});
    CHECK(told("path: out/shot.usda, volumes: {smoke: sim}, files: {bank: out/b.usda}") ==
          Texts{"usd.write needs the file of volume 'smoke': name it in 'files: {smoke: ...}'"});
    CHECK(told("path: out/shot.usda, volumes: {bank: sim}, files: {bank: out/b.usda}") ==
          Texts{"usd.write needs the .vdb file of volume 'bank', not out/b.usda"});
    CHECK(told("path: out/shot.usda, files: {}") ==
          Texts{"usd.write holds files together, but 'files' names none"});
}

TEST_CASE("usd.write refuses what USD can't take: other files, other names") {
    CHECK(told("path: out/shot.usda, files: {sheet: out/s.png}") ==
          Texts{"usd.write takes .vdb and .usda files, not out/s.png; mesh.write and points.write "
                "make .usda files, too"});
    CHECK(told("path: out/shot.usda, files: {2b: out/b.usda}") ==
          Texts{"usd.write can't name a prim '2b'; use letters, digits and _, and no digit first"});
    CHECK(told("path: out/shot.usd, files: {bank: out/b.usda}") ==
          Texts{"usd.write writes a .usda file, not '.usd'"});
}

TEST_CASE("usd.write clashes with no other file, and is one for all frames") {
    CHECK(told("path: out/b.usda, files: {bank: out/b.usda}") ==
          Texts{"'shot' would overwrite a file of the same pipeline"});
    CHECK(
        told("path: out/shot.####.usda, volumes: {smoke: sim}, files: {smoke: out/s.####.vdb}") ==
        Texts{
            "usd.write writes one file here, not one per frame: 'path' can't have a frame token"});
}
