#include "formats/file/confinement.h"
#include "formats/file/input_file.h"
#include "formats/file/output_file.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <functional>

using namespace fluidcarve;
namespace fs = std::filesystem;

namespace {

/// A folder `in` to be confined to, beside a folder `out` with a file.
struct Places {
    Places() {
        fs::create_directories(scratch / "in/sub");
        fs::create_directories(scratch / "in2");
        fs::create_directories(scratch / "out");
        scratch.write("in/a", "");
        scratch.write("out/a", "");
    }
    void link(const std::string& name, const std::string& to) const {
        fs::create_symlink(to, scratch / name);
    }
    bool allows(const std::string& path) const {
        return Confinement({scratch / "in"}).refusal(path).empty();
    }

    Scratch scratch;
};

/// Whether a call is refused in a process that is confined to a folder: for good, so that it must
/// be another one.
bool refused_within(const std::string& folder, const std::function<void()>& call) {
    const auto child = fork();
    if (child == 0) {
        try {
            Confinement::confine_program({folder});
            call();
            _exit(0);
        } catch (const Failure& failure) {
            _exit(std::string(failure.what()).find("outside of --confine") != std::string::npos
                      ? 1
                      : 2);
        }
    }
    int status = 0;
    waitpid(child, &status, 0);
    REQUIRE(WIFEXITED(status));
    REQUIRE(WEXITSTATUS(status) < 2);
    return WEXITSTATUS(status) == 1;
}

}  // namespace

TEST_CASE("without folders everything is allowed") {
    CHECK_FALSE(Confinement().on());
    CHECK(Confinement().refusal("/etc/passwd").empty());
}

TEST_CASE("what lies in a folder is allowed, there or not yet, and nothing beside it") {
    const Places at;
    for (const auto* const path :
         {"in/a", "in", "in/", "in/sub/../a", "in/new/deep/a", "in//a", "out/../in/a"}) {
        INFO(path);
        CHECK(at.allows(at.scratch / path));
    }
    for (const auto* const path :
         {"out/a", "in2/a", "in/../out/a", "in/new/../../out/a", "", "new", "in/../in2/new"}) {
        INFO(path);
        CHECK_FALSE(at.allows(at.scratch / path));
    }
    CHECK(
        Confinement({at.scratch / "in", at.scratch / "out"}).refusal(at.scratch / "out/a").empty());
    CHECK(Confinement({"/"}).refusal("/etc/passwd").empty());
    CHECK(Confinement({"."}).refusal("some/file").empty());
    CHECK_FALSE(Confinement({"."}).refusal("../file").empty());
}

TEST_CASE("links are followed, of files and folders, also to what is not there yet") {
    const Places at;
    at.link("in/file", at.scratch / "out/a");
    at.link("in/folder", "../out");
    at.link("in/dangling", at.scratch / "nowhere/new");
    at.link("in/first", "second");
    at.link("in/second", "sub/../../out/a");
    at.link("in/around", "around");
    for (const auto* const path :
         {"in/file", "in/folder/a", "in/folder/new", "in/folder/../in/a/../../out/a", "in/dangling",
          "in/dangling/a", "in/first", "in/around"}) {
        INFO(path);
        CHECK_FALSE(at.allows(at.scratch / path));
    }
    at.link("in/inner", "sub");
    at.link("door", at.scratch / "in");
    CHECK(at.allows(at.scratch / "in/inner/new"));
    CHECK(at.allows(at.scratch / "door/a"));
    CHECK(at.allows(at.scratch / "in/folder/../in/a"));
    CHECK(Confinement({at.scratch / "door"}).refusal(at.scratch / "in/a").empty());
}

TEST_CASE("a refusal names the place, the folders and the remedy") {
    const Places at;
    at.link("in/file", at.scratch / "out/a");
    const auto root = fs::canonical(at.scratch.path()).string();
    CHECK(Confinement({at.scratch / "in", at.scratch / "in2"}).refusal(at.scratch / "in/file") ==
          "leads to " + root + "/out/a, outside of --confine (" + root + "/in, " + root +
              "/in2); move it there, or name its folder by another --confine");
}

TEST_CASE("an open file is judged by where it lies") {
    const Places at;
    const Confinement confinement({at.scratch / "in"});
    for (const auto* const folder : {"in", "out"}) {
        const int file = open((at.scratch / folder + "/a").c_str(), O_RDONLY);
        REQUIRE(file >= 0);
        CHECK(confinement.refusal_of_open(file).empty() == (folder == std::string("in")));
        close(file);
    }
}

TEST_CASE("only folders that exist confine") {
    const Places at;
    for (const auto& folder : {at.scratch / "none", at.scratch / "in/a", std::string()}) {
        INFO(folder);
        CHECK_THROWS_AS(Confinement({folder}), Failure);
    }
}

TEST_CASE("a confined process opens files within its folder only") {
    const Places at;
    at.link("in/file", at.scratch / "out/a");
    at.link("in/folder", at.scratch / "out");
    const auto reads = [&](const std::string& path, bool anywhere = false) {
        return !refused_within(at.scratch / "in", [&] {
            InputFile(path, {.what = "a song", .anywhere = anywhere}).whole();
        });
    };
    CHECK(reads(at.scratch / "in/a"));
    CHECK_FALSE(reads(at.scratch / "out/a"));
    CHECK_FALSE(reads(at.scratch / "in/file"));
    CHECK(reads(at.scratch / "out/a", true));
    const auto writes = [&](const std::string& path) {
        return !refused_within(at.scratch / "in", [&] { OutputFile::write(path, "text"); });
    };
    CHECK(writes(at.scratch / "in/b"));
    CHECK(writes(at.scratch / "in/new/b"));
    CHECK_FALSE(writes(at.scratch / "out/b"));
    CHECK_FALSE(writes(at.scratch / "in/folder/new/b"));
    CHECK_FALSE(writes(at.scratch / "in/file"));
    CHECK_FALSE(writes("/dev/null"));
    CHECK_FALSE(fs::exists(at.scratch / "out/new"));
    CHECK(Scratch::read(at.scratch / "out/a") == "");
}

TEST_CASE("a link that changes before the commit does not lead a confined process out") {
    const Places at;
    at.link("in/folder", "sub");
    CHECK(refused_within(at.scratch / "in", [&] {
        OutputFile file(at.scratch / "in/folder/b");
        fs::remove(at.scratch / "in/folder");
        at.link("in/folder", at.scratch / "out");
        file.commit();
    }));
    CHECK_FALSE(fs::exists(at.scratch / "out/b"));
}
