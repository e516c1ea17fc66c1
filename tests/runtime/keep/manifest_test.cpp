#include "runtime/keep/manifest.h"
#include "carve/base/failure.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <thread>
#include <vector>

using namespace fluidcarve;
namespace fs = std::filesystem;

namespace {

const std::string head = "# fluidcarve manifest 1: XXH128, bytes, path\n";
const std::string smoke = "355f1a714d5ed97edf1e808228fab676  5  ";
const std::string fire = "af9be8b2495b4c42b073e5d97e327b72  4  ";

/// A manifest over two files below its folder and one beside it.
struct Listed {
    Scratch scratch;
    std::string path = scratch / "shot/shot.manifest";

    Listed() {
        fs::create_directories(scratch / "shot/in");
        scratch.write("shot/in/1.vdb", "smoke");
        scratch.write("shot/in/2.vdb", "fire");
        scratch.write("rig.txt", "smoke");
        save({"shot/in/2.vdb", "shot/in/1.vdb", "rig.txt"});
    }
    Manifest::Counts save(const std::vector<std::string>& files) const {
        Manifest manifest(path);
        for (const auto& file : files) manifest.require(scratch / file);
        return manifest.save();
    }
    std::string text() const { return Scratch::read(path); }
    std::string whole() const {
        return head + smoke + (scratch / "rig.txt") + "\n" + smoke + "in/1.vdb\n" + fire +
               "in/2.vdb\n";
    }
    /// What is wrong with a file.
    std::string fault(const std::string& file) const {
        try {
            save({file});
        } catch (const Failure& failure) {
            CHECK(failure.kind == Failure::Kind::input);
            return failure.what();
        }
        return {};
    }
};

}  // namespace

TEST_CASE("a manifest lists hash, size and path of each file, sorted by path") {
    const Listed listed;
    CHECK(listed.text() == listed.whole());
    CHECK_FALSE(fs::exists(listed.path + ".lock"));
}

TEST_CASE("files that are as the manifest lists them pass, and it stays as it is") {
    const Listed listed;
    const auto counts = listed.save({"shot/in/1.vdb", "shot/../shot/in/2.vdb", "rig.txt"});
    CHECK(counts.listed == 3);
    CHECK(counts.added == 0);
    CHECK(listed.text() == listed.whole());
    fs::rename(listed.scratch / "shot", listed.scratch / "moved");
    Manifest moved(listed.scratch / "moved/shot.manifest");
    CHECK_NOTHROW(moved.require(listed.scratch / "moved/in/1.vdb"));
    CHECK(moved.save().listed == 1);
}

TEST_CASE("a byte that rotted and a file that was cut off are told") {
    const Listed listed;
    const auto file = listed.scratch.write("shot/in/1.vdb", "smoKe");
    const auto told = [&](const std::string& fault) {
        return file + " is not the file that the manifest " + listed.path + " knows: " + fault +
               "; restore it, or delete its line from the manifest to accept it";
    };
    CHECK(listed.fault("shot/in/1.vdb") == told("its hash differs"));
    listed.scratch.write("shot/in/1.vdb", "smo");
    CHECK(listed.fault("shot/in/1.vdb") == told("it has 3 bytes and had 5"));
    CHECK(listed.fault("shot/in/2.vdb") == "");
    fs::remove(file);
    CHECK(listed.fault("shot/in/1.vdb") == file + " does not exist");
    CHECK(listed.text() == listed.whole());
}

TEST_CASE("a file whose entry is missing is added, and all others stay") {
    const Listed listed;
    std::ofstream(listed.path) << head + smoke + "gone.vdb\n" + fire + "in/2.vdb\n";
    const auto counts = listed.save({"shot/in/1.vdb", "shot/in/2.vdb"});
    CHECK(counts.listed == 1);
    CHECK(counts.added == 1);
    CHECK(listed.text() ==
          head + smoke + "gone.vdb\n" + smoke + "in/1.vdb\n" + fire + "in/2.vdb\n");
}

TEST_CASE("a damaged manifest is refused with the line") {
    const Listed listed;
    const auto refused = [&](const std::string& text, const std::string& fault) {
        std::ofstream(listed.path) << text;
        CHECK(listed.fault("rig.txt") ==
              listed.path + ", " + fault +
                  "; restore the manifest, or delete it to begin a new one");
        CHECK(listed.text() == text);
    };
    const std::string wrong_head = "it is not '" + head.substr(0, head.size() - 1) + "'";
    refused("", "line 1: it is cut off");
    refused("smoke\n", "line 1: " + wrong_head);
    refused("# fluidcarve manifest 2: XXH128, bytes, path\n", "line 1: " + wrong_head);
    refused(head + smoke + "a\n\n", "line 3: it does not begin with a hash of 32 hex digits");
    refused(head + smoke + "a\n" + smoke.substr(1) + "b\n",
            "line 3: it does not begin with a hash of 32 hex digits");
    refused(head + smoke.substr(0, 34) + "x  a\n", "line 2: no number of bytes follows the hash");
    refused(head + smoke.substr(0, 32) + "\n", "line 2: no number of bytes follows the hash");
    refused(head + smoke + "\n", "line 2: no path follows the number of bytes");
    refused(head + smoke.substr(0, 36) + "a\n", "line 2: no path follows the number of bytes");
    refused(head + smoke + "a\n" + fire + "a\n", "line 3: a is listed twice");
    refused(head + smoke + "a\n" + fire + "b", "line 3: it is cut off");
}

TEST_CASE("processes that write one manifest at a time lose no line") {
    const Scratch scratch;
    constexpr int writers = 8;
    std::vector<std::thread> threads;
    for (int n = 0; n < writers; ++n) {
        const auto file = scratch.write(std::to_string(n), "smoke");
        threads.emplace_back([&scratch, file] {
            Manifest manifest(scratch / "m");
            manifest.require(file);
            manifest.save();
        });
    }
    for (auto& thread : threads) thread.join();
    auto all = head;
    for (int n = 0; n < writers; ++n) all += smoke + std::to_string(n) + "\n";
    CHECK(Scratch::read(scratch / "m") == all);
    CHECK_FALSE(fs::exists(scratch / "m.lock"));
}

TEST_CASE("what another process met differently is told, and its line stays") {
    const Listed listed;
    fs::remove(listed.path);
    Manifest late(listed.path);
    late.require(listed.scratch / "rig.txt");
    listed.scratch.write("rig.txt", "other");
    listed.save({"rig.txt"});
    const auto before = listed.text();
    CHECK_THROWS_WITH(late.save(), Catch::Contains("rig.txt is not the file that the manifest ") &&
                                       Catch::Contains("its hash differs"));
    CHECK(listed.text() == before);
}

TEST_CASE(
    "a file that no longer is what earlier runs knew is told, though the manifest does not list it "
    "yet") {
    const Listed listed;
    const auto file = listed.scratch.write("new", "smoke");
    Manifest manifest(listed.path);
    manifest.require(file, {Hash{1, 2}, 5});
    CHECK_THROWS_WITH(manifest.require(file),
                      Catch::StartsWith(file + " is not the file that earlier runs knew") &&
                          Catch::Contains("its hash differs"));
    CHECK_THROWS_WITH(manifest.require(listed.scratch / "rig.txt", {Hash{1, 2}, 5}),
                      Catch::Contains(" is not the file that the manifest "));
}

TEST_CASE("paths may hold line breaks and backslashes") {
    const Scratch scratch;
    const auto odd = scratch.write("a\\n\nb", "smoke");
    for (const std::size_t added : {1U, 0U}) {
        Manifest manifest(scratch / "m");
        manifest.require(odd);
        CHECK(manifest.save().added == added);
    }
    CHECK(Scratch::read(scratch / "m") == head + smoke + "a\\\\n\\nb\n");
}

TEST_CASE(
    "a manifest that can't be written is told at once, and one that lists all may stay out of "
    "reach") {
    CHECK_THROWS_WITH(Manifest("/proc/nowhere/m"),
                      Catch::StartsWith("cannot write /proc/nowhere/m: "));
    const Scratch scratch;
    fs::create_directory(scratch / "m");
    CHECK_THROWS_WITH(Manifest(scratch / "m"), (scratch / "m") + " is a folder");
}
