#include "tools/reading/sequences.h"

#include "carve/base/failure.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

using namespace fluidcarve;

namespace {

std::vector<std::string> texts(const std::vector<FileSequence>& sequences) {
    std::vector<std::string> out;
    for (const auto& each : sequences) out.push_back(each.text());
    return out;
}

}  // namespace

TEST_CASE("files that differ by a number before the ending are one sequence") {
    CHECK(texts(sequences_of(
              {"b/x.0003.vdb", "b/x.0001.vdb", "b/x.0002.vdb", "a.vdb", "b/x.0001.obj"})) ==
          std::vector<std::string>{"b/x.####.vdb 1-3", "a.vdb", "b/x.0001.obj"});
    CHECK(texts(sequences_of({"x9.vdb", "x10.vdb", "x11.vdb"})) ==
          std::vector<std::string>{"x#.vdb 9-11"});
    CHECK(texts(sequences_of({"7.vdb", "8.vdb", "9.vdb"})) ==
          std::vector<std::string>{"#.vdb 7-9"});
    CHECK(sequences_of({"x.1001.vdb", "x.1002.vdb"}).front().path.at(1002) == "x.1002.vdb");
}

TEST_CASE("numbers of several forms, or beyond all frames, make no sequence") {
    CHECK(texts(sequences_of({"x.001.vdb", "x.2.vdb"})) ==
          std::vector<std::string>{"x.001.vdb", "x.2.vdb"});
    CHECK(texts(sequences_of({"x.99999999998.vdb", "x.99999999999.vdb"})) ==
          std::vector<std::string>{"x.99999999998.vdb", "x.99999999999.vdb"});
    // A name with what looks like a token of its own.
    CHECK(texts(sequences_of({"$F.1.vdb", "$F.2.vdb"})) ==
          std::vector<std::string>{"$F.1.vdb", "$F.2.vdb"});
}

TEST_CASE("the files of a folder, or of a path with a frame token, are found") {
    const Scratch scratch;
    for (const auto* const name : {"x.0008.vdb", "x.0009.vdb", "x.0010.vdb", "x.10000.vdb",
                                   "x.07.vdb", "y.0001.vdb", "notes.txt"})
        scratch.write(name, "");
    CHECK(named_sequence(scratch / "x.####.vdb").text() ==
          (scratch / "x.####.vdb") + " 8-10,10000");
    CHECK(named_sequence(scratch / "z.####.vdb").frames.frames().empty());
    CHECK_FALSE(named_sequence(scratch / "x.0008.vdb").per_frame());
    std::size_t others = 0;
    const auto wanted = [](const std::string& path) {
        return path.ends_with(".vdb") && path.find("x.07") == std::string::npos;
    };
    CHECK(
        texts(sequences_in(scratch.path(), wanted, others)) ==
        std::vector<std::string>{(scratch / "x.####.vdb") + " 8-10,10000", scratch / "y.0001.vdb"});
    CHECK(others == 2);
    try {
        named_sequence("x.@@@@.vdb");
        FAIL("taken");
    } catch (const Failure& failure) {
        CHECK(failure.what() ==
              std::string("x.@@@@.vdb has '@@@@', which is no frame token; write #### or %04d"));
    }
}
