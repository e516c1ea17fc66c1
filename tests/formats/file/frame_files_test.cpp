#include "formats/file/frame_files.h"
#include "carve/base/frame_set.h"
#include "formats/file/path_pattern.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <random>

using namespace fluidcarve;

namespace {

std::vector<int> frames_of(std::string_view text) {
    std::string fault;
    const auto set = FrameSet::parse(text, fault);
    INFO(text << ": " << fault);
    REQUIRE(set);
    return set->frames();
}

std::string fault_of_frames(std::string_view text) {
    std::string fault;
    REQUIRE_FALSE(FrameSet::parse(text, fault));
    return fault;
}

std::string shortest(std::string_view text) { return FrameSet(frames_of(text)).text(); }

using Frames = std::vector<int>;

}  // namespace

TEST_CASE("frame sets are ranges, steps and lists of them") {
    CHECK(frames_of("7") == Frames{7});
    CHECK(frames_of("1001-1004") == Frames{1001, 1002, 1003, 1004});
    CHECK(frames_of("1-3,20-21") == Frames{1, 2, 3, 20, 21});
    CHECK(frames_of(" 1-3 ,  9 ") == Frames{1, 2, 3, 9});
    CHECK(frames_of("1-10x3") == Frames{1, 4, 7, 10});
    CHECK(frames_of("1-9x3") == Frames{1, 4, 7});
    CHECK(frames_of("1-10y3") == Frames{2, 3, 5, 6, 8, 9});
    CHECK(frames_of("1-10:3") == frames_of("1-10"));
}

TEST_CASE("frames may be negative") {
    CHECK(frames_of("-5") == Frames{-5});
    CHECK(frames_of("-5--3") == Frames{-5, -4, -3});
    CHECK(frames_of("-2-1") == Frames{-2, -1, 0, 1});
}

TEST_CASE("a frame set is ordered, each frame once, whatever the text's order") {
    CHECK(frames_of("5,1-3,2,5") == Frames{1, 2, 3, 5});
    CHECK(frames_of("4-1") == Frames{1, 2, 3, 4});
    CHECK(frames_of("10-1x4") == Frames{2, 6, 10});
    CHECK(frames_of("10-1x-4") == Frames{2, 6, 10});
}

TEST_CASE("what is no frame set is told in words") {
    const std::string form = "is no frame or range; write 1001, 1001-1084 or 1001-1084x2";
    CHECK(fault_of_frames("") == "no frame is named; write 1001, 1001-1084 or 1001-1084x2");
    CHECK(fault_of_frames("  ") == "no frame is named; write 1001, 1001-1084 or 1001-1084x2");
    CHECK(fault_of_frames("1-10x0") == "'1-10x0' has a step of 0; the least is 1");
    CHECK(fault_of_frames("1-10x-2") == "'1-10x-2' has a negative step, but does not descend");
    CHECK(fault_of_frames("1-10y1") == "'1-10y1' leaves no frame");
    CHECK(fault_of_frames("1-1000001") == "'1-1000001' names more than 1000000 frames");
    CHECK(fault_of_frames("-2147483648-2147483647y1000000000") ==
          "'-2147483648-2147483647y1000000000' names more than 1000000 frames");
    CHECK(fault_of_frames("1-600000,1-600000") ==
          "'1-600000,1-600000' names more than 1000000 frames");
    for (const std::string large : {"99999999999", "1-99999999999", "-99999999999-1",
                                    "1-10x99999999999", "1-99999999999999999999999999"})
        CHECK(fault_of_frames("1-5," + large) ==
              "'" + large + "' has a number beyond 2147483647, the most that a frame can be");
    for (const std::string bad : {"a", "1-", "1-a", "1 - 3", "1-10x", "1-10z2", "1-10x2x2", "5x2",
                                  "1.5", "0x10", "1-10x2 3", "+1", "a-b", "5-", "-", "--5"})
        CHECK(fault_of_frames(bad) == "'" + bad + "' " + form);
    CHECK(fault_of_frames("1,,2") == "'' " + form);
    CHECK(fault_of_frames("1,") == "'' " + form);
    CHECK(frames_of("1-1000000").size() == 1000000);
    CHECK(frames_of("-2147483648-2147483647x1000000000").size() == 5);
}

TEST_CASE("a frame set's text is short and reads back") {
    CHECK(shortest("1001-1084") == "1001-1084");
    CHECK(shortest("1-9x2") == "1-9x2");
    CHECK(shortest("1,2") == "1,2");
    CHECK(shortest("3") == "3");
    CHECK(shortest("-5--1") == "-5--1");
    CHECK(shortest("1,3,5,6,7,8") == "1,3,5-8");
    CHECK(shortest("1-99x7,100,101") == "1-92x7,99-101");
    CHECK(shortest("1-10y3") == "2,3,5,6,8,9");
    CHECK(FrameSet().text().empty());
    std::mt19937 random(1);
    for (int trial = 0; trial < 300; ++trial) {
        Frames frames;
        const auto share = 1 + random() % 9;
        for (int frame = -12; frame < 30; ++frame)
            if (random() % 10 < share) frames.push_back(frame);
        if (!frames.empty()) CHECK(frames_of(FrameSet(frames).text()) == frames);
    }
}

TEST_CASE("a frame's place counts from the first of its set") {
    const FrameSet set({4, 2, 8});
    CHECK(set.place(2) == 0);
    CHECK(set.place(8) == 2);
    CHECK_FALSE(set.place(5));
    CHECK(set.contains(4));
    CHECK_FALSE(set.contains(3));
}

TEST_CASE("every form of frame token takes the frame's number") {
    CHECK(PathPattern("a.####.vdb").at(45) == "a.0045.vdb");
    CHECK(PathPattern("a.##.vdb").at(1045) == "a.1045.vdb");
    CHECK(PathPattern("a.%04d.vdb").at(45) == "a.0045.vdb");
    CHECK(PathPattern("a.%d.vdb").at(45) == "a.45.vdb");
    CHECK(PathPattern("a.$F4.vdb").at(45) == "a.0045.vdb");
    CHECK(PathPattern("a.$F.vdb").at(45) == "a.45.vdb");
    CHECK(PathPattern("a.<frame>.vdb").at(45) == "a.45.vdb");
    CHECK(PathPattern("a.<frame04>.vdb").at(45) == "a.0045.vdb");
    CHECK(PathPattern("v####/a.$F6.vdb").at(7) == "v0007/a.000007.vdb");
    CHECK(PathPattern("a.####.vdb").per_frame());
}

TEST_CASE("negative frames are padded as in fileseq") {
    CHECK(PathPattern("a.####.vdb").at(-5) == "a.-005.vdb");
}

TEST_CASE("a file's name is known but for its numbers, if its folder has none") {
    const auto ends = [](const char* text) {
        const auto found = PathPattern(text, "shots").name_ends();
        return found ? found->begin + " " + found->end : std::string("none");
    };
    CHECK(ends("v1/a.####.vdb") == "a. .vdb");
    CHECK(ends("####") == " ");
    CHECK(ends("a.#-b-##c/") == "none");
    CHECK(ends("a.#-b-##c") == "a. c");
    CHECK(ends("a/b.vdb") == "b.vdb b.vdb");
    CHECK(ends("v####/a.#.vdb") == "none");
    const auto fit = [](const char* a, const char* b) {
        return PathPattern(a).name_ends()->fits(*PathPattern(b).name_ends());
    };
    CHECK(fit("a.#.vdb", "a.<frame>.vdb"));
    CHECK(fit("a.#.vdb", "a.1#.vdb"));
    CHECK(fit("a.#.vdb", "a.-#.vdb"));
    CHECK(fit("a.#.vdb", "a.0007.vdb"));
    CHECK(fit("a.#", "a.#7"));
    CHECK_FALSE(fit("a.#.vdb", "a.b.#.vdb"));
    CHECK_FALSE(fit("a.#.vdb", "a.#.obj"));
    CHECK_FALSE(fit("a.#", "a.#.b"));
    CHECK_FALSE(fit("a.#.vdb", "b.0007.vdb"));
}

TEST_CASE("a path without a token is the same for every frame") {
    const PathPattern path("50% of a$/<1>@b.vdb");
    CHECK_FALSE(path.per_frame());
    CHECK(path.bad_token().empty());
    CHECK(path.at(3) == path.text());
}

TEST_CASE("a relative path starts at its folder, an absolute one does not") {
    CHECK(PathPattern("a.#.vdb", "shots/x").at(3) == "shots/x/a.3.vdb");
    CHECK(PathPattern("a.vdb", "shots/").at(3) == "shots/a.vdb");
    CHECK(PathPattern("/a.#.vdb", "shots/x").at(3) == "/a.3.vdb");
}

TEST_CASE("what only looks like a frame token is found") {
    const auto bad = [](const char* text) { return PathPattern(text).bad_token(); };
    CHECK(bad("a.%4d.vdb") == "%4d");
    CHECK(bad("a.%04x.vdb") == "%04x");
    CHECK(bad("a.%099d.vdb") == "%099d");
    CHECK(bad("a.$F99.vdb") == "$F99");
    CHECK(bad("a.$f4.vdb") == "$f4");
    CHECK(bad("a.$FF.vdb") == "$FF");
    CHECK(bad("$JOB/a.$F4.vdb") == "$JOB");
    CHECK(bad("a.${F4}.vdb") == "${");
    CHECK(bad("a.<fram>.vdb") == "<fram>");
    CHECK(bad("a.<frame4x>.vdb") == "<frame4x>");
    CHECK(bad("a.<frame4>.vdb") == "<frame4>");
    CHECK(bad("a.<frame.vdb") == "<frame");
    CHECK(bad("a.@@@@.vdb") == "@@@@");
    CHECK(bad("a.####.vdb").empty());
}

TEST_CASE("a pattern exists where a file fits it") {
    const Scratch folder;
    folder.write("a[1].0045.vdb", "");
    folder.write("b.final.vdb", "");
    folder.write("c.-005.vdb", "");
    folder.write("d.10450.vdb", "");
    const auto exists = [&](const char* text) { return PathPattern(text, folder.path()).exists(); };
    CHECK(exists("a[1].####.vdb"));
    CHECK(exists("a[1].0045.vdb"));
    CHECK_FALSE(exists("a1.####.vdb"));
    CHECK_FALSE(exists("b.####.vdb"));
    CHECK(exists("b.final.vdb"));
    CHECK(exists("c.####.vdb"));
    CHECK(exists("d.####.vdb"));
    CHECK_FALSE(exists("d.######.vdb"));
    CHECK_FALSE(PathPattern("x.####.vdb", "/nowhere").exists());
}

TEST_CASE("the last number of a file's name becomes a frame token") {
    CHECK(with_frame_token("in/smoke.0051.vdb") == "in/smoke.####.vdb");
    CHECK(with_frame_token("smoke_v2.7.vdb") == "smoke_v2.#.vdb");
    CHECK(with_frame_token("0051.vdb") == "####.vdb");
    CHECK(with_frame_token("sh010/v2/smoke.vdb") == "");
    CHECK(with_frame_token("smoke.mp4") == "");
    CHECK(with_frame_token("smoke7") == "");
    CHECK(with_frame_token("smoke.123456789012.vdb") == "");
    CHECK(with_frame_token(".7") == "");
}

TEST_CASE("numbers that outgrow their token, and those below zero, are frames like others") {
    const Scratch scratch;
    for (const std::string name :
         {"a.998.vdb", "a.999.vdb", "a.1000.vdb", "a.1001.vdb", "b.9999.vdb", "b.10000.vdb",
          "b.10001.vdb", "c.-002.vdb", "c.-001.vdb", "c.0000.vdb", "c.0001.vdb"})
        scratch.write(name, "");
    const auto there = [&](const std::string& path) {
        return frames_there(PathPattern(scratch / path))->text();
    };
    CHECK(there("a.###.vdb") == "998-1001");
    CHECK(there("b.####.vdb") == "9999-10001");
    CHECK(there("c.####.vdb") == "-2-1");
    CHECK(PathPattern("a.###.vdb").at(1002) == "a.1002.vdb");
    CHECK(PathPattern("c.####.vdb").at(-1) == "c.-001.vdb");
    // Too few digits for the token.
    CHECK(there("a.####.vdb") == "1000,1001");
    CHECK(odd_frames_there(PathPattern(scratch / "a.####.vdb")) ==
          std::vector<std::string>{"a.998.vdb", "a.999.vdb"});
}
