#include "runtime/keep/input_guard.h"
#include "carve/base/failure.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <fcntl.h>
#include <sys/stat.h>
#include <new>

using namespace fluidcarve;
namespace fs = std::filesystem;

namespace {

std::string changed(const std::string& file) {
    return file + " was changed while the run was on; run again when its writer is done";
}

void nothing() {}

}  // namespace

TEST_CASE("files that stay as they are may be read again and again") {
    const Scratch scratch;
    const auto a = scratch.write("a", "one"), b = scratch.write("b", "one");
    InputGuard guard(nullptr, {a});
    int calls = 0;
    for (int pass = 0; pass < 3; ++pass) guard.read({a, b, scratch / "none"}, [&] { ++calls; });
    CHECK(calls == 3);
}

TEST_CASE("a file that changed since it was first looked at is not read") {
    const Scratch scratch;
    const auto a = scratch.write("a", "one"), b = scratch.write("b", "one");
    InputGuard guard(nullptr, {a});
    guard.read({b}, nothing);
    scratch.write("a", "another");
    scratch.write("b", "another");
    bool called = false;
    for (const auto& file : {a, b})
        CHECK_THROWS_WITH(guard.read({file}, [&] { called = true; }), changed(file));
    CHECK_FALSE(called);
    try {
        guard.read({a}, nothing);
    } catch (const Failure& failure) {
        CHECK(failure.kind == Failure::Kind::input);
    }
}

TEST_CASE("a file of the same size and time in the place of another is another") {
    const Scratch scratch;
    const auto a = scratch.write("a", "one"), b = scratch.write("b", "two");
    struct stat about {};
    REQUIRE(stat(a.c_str(), &about) == 0);
    const timespec times[2] = {about.st_atim, about.st_mtim};
    REQUIRE(utimensat(AT_FDCWD, b.c_str(), times, 0) == 0);
    InputGuard guard(nullptr, {a});
    fs::rename(b, a);
    CHECK_THROWS_WITH(guard.read({a}, nothing), changed(a));
}

TEST_CASE(
    "a file that changes, appears or goes while it is read is told, whatever the reader made of "
    "it") {
    const Scratch scratch;
    const auto a = scratch.write("a", "one"), b = scratch / "b", c = scratch.write("c", "one"),
               d = scratch.write("d", "one");
    InputGuard guard(nullptr, {a, b, c, d});
    CHECK_THROWS_WITH(guard.read({a}, [&] { scratch.write("a", "another"); }), changed(a));
    CHECK_THROWS_WITH(guard.read({b}, [&] { scratch.write("b", "one"); }), changed(b));
    CHECK_THROWS_WITH(guard.read({c}, [&] { fs::remove(c); }), changed(c));
    const auto fails = [&] {
        scratch.write("d", "another");
        throw std::bad_alloc();
    };
    CHECK_THROWS_WITH(guard.read({d}, fails), changed(d));
}

TEST_CASE("what a reader throws passes, if its files are as they were") {
    const Scratch scratch;
    InputGuard guard(nullptr, {scratch.write("a", "one")});
    CHECK_THROWS_WITH(guard.read({scratch / "a"}, [] { throw Failure("is damaged"); }),
                      "is damaged");
    CHECK_THROWS_AS(guard.read({scratch / "a"}, [] { throw Cancelled(); }), Cancelled);
}

TEST_CASE("with a manifest, a file that it lists with another content is not read") {
    const Scratch scratch;
    const auto a = scratch.write("a", "one");
    {
        Manifest manifest(scratch / "m");
        InputGuard(&manifest, {a}).read({a, scratch / "none"}, nothing);
        CHECK(manifest.save().added == 1);
    }
    scratch.write("a", "two");
    Manifest manifest(scratch / "m");
    bool called = false;
    CHECK_THROWS_WITH(InputGuard(&manifest, {a}).read({a}, [&] { called = true; }),
                      Catch::Contains("its hash differs"));
    CHECK_FALSE(called);
}
