#include "formats/file/output_file.h"
#include "carve/base/failure.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

using namespace fluidcarve;

namespace {
std::vector<std::string> flushed;  ///< what fsync was called with
int fault_of_disk = 0;             ///< errno that fsync fails with
}  // namespace

/// In place of the system's.
extern "C" int fsync(int file) {
    flushed.push_back(
        std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(file)).string());
    errno = fault_of_disk;
    return fault_of_disk == 0 ? 0 : -1;
}

TEST_CASE("what a killed run of the same process number left aside does not stop the next") {
    const Scratch scratch;
    for (int serial = 0; serial < 100; ++serial)
        scratch.write(".o." + std::to_string(getpid()) + "." + std::to_string(serial) + ".part.txt",
                      "old");
    OutputFile file(scratch / "o.txt");
    std::ofstream(file.aside()) << "new";
    file.commit();
    CHECK(Scratch::read(scratch / "o.txt") == "new");
}

TEST_CASE(
    "a long name is written, and a file that takes the place of another keeps who may read it") {
    const Scratch scratch;
    const auto name = std::string(240, 'x') + ".txt";
    OutputFile::write(scratch / name, "new");
    CHECK(Scratch::read(scratch / name) == "new");
    OutputFile::write(scratch / "mine.txt", "old");
    REQUIRE(chmod((scratch / "mine.txt").c_str(), 0600) == 0);
    OutputFile::write(scratch / "mine.txt", "new");
    struct stat file {};
    REQUIRE(stat((scratch / "mine.txt").c_str(), &file) == 0);
    CHECK((file.st_mode & 0777) == 0600);
    CHECK(Scratch::read(scratch / "mine.txt") == "new");
}

TEST_CASE("a temporary file is known by its name, whatever is to become of it") {
    const Scratch scratch;
    for (const std::string name : {"o.txt", "two.dots.vdb", "bare", ".hidden", "some.part",
                                   "some.partial", "some.part.vdb"}) {
        INFO(name);
        const OutputFile file(scratch / name);
        CHECK(OutputFile::is_aside(std::filesystem::path(file.aside()).filename().string()));
        CHECK(std::filesystem::path(file.aside()).extension() ==
              (name == "bare" || name == ".hidden" ? ".part"
                                                   : std::filesystem::path(name).extension()));
        CHECK(!OutputFile::is_aside(name));
    }
    for (const std::string name :
         {".o.part", ".o.1.2.part", ".o.0123456789abcdef.1.part", ".0123456789abcdef.1.2.part",
          "o.0123456789abcdef.1.2.part", "."})
        CHECK(!OutputFile::is_aside(name));
}

TEST_CASE("what a killed process left aside goes with the next file in its folder") {
    const Scratch scratch;
    std::string left;
    {
        const OutputFile file(scratch / "first/o.part");
        left = std::filesystem::path(file.aside()).filename().string();
    }
    const auto mine = "." + std::to_string(getpid()) + ".";
    left.replace(left.find(mine), mine.size(), ".2147483647.");
    std::filesystem::create_directory(scratch / "second");
    const auto orphan = scratch.write("second/" + left, ""),
               other = scratch.write("second/.o.0123456789abcdef.2147483647.0.part", "");
    const OutputFile file(scratch / "second/o.part");
    CHECK(!std::filesystem::exists(orphan));
    CHECK(std::filesystem::exists(other));
}

namespace {

template <class Call>
std::string fault_of_output(const Call& call) {
    try {
        call();
    } catch (const Failure& failure) {
        return failure.what();
    }
    return "";
}

}  // namespace

TEST_CASE("a device or a pipe is never replaced by a file, but takes a text") {
    const Scratch scratch;
    const auto pipe = scratch / "pipe", link = scratch / "link";
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    std::filesystem::create_symlink("/dev/full", link);
    for (const auto& path : {pipe, link, std::string("/dev/null")})
        CHECK(fault_of_output([&] { const OutputFile file(path); }) ==
              "cannot write " + path +
                  ": it is a device or a pipe, which a file must not replace; name a regular file");
    CHECK(fault_of_output([&] { OutputFile::write("/dev/null", "text"); }) == "");
    CHECK(fault_of_output([&] { OutputFile::write("/dev/full", "text"); }) ==
          "cannot write /dev/full: No space left on device");
    CHECK(fault_of_output([&] { OutputFile::write(pipe, "text"); }) ==
          "cannot write " + pipe + ": nobody reads this pipe");
    CHECK(std::filesystem::is_fifo(pipe));
    CHECK(std::filesystem::is_character_file(link));

    std::string read;
    std::thread reader([&] { read = Scratch::read(pipe); });
    while (!fault_of_output([&] { OutputFile::write(pipe, "text"); }).empty())
        std::this_thread::yield();
    reader.join();
    CHECK(read == "text");
}

TEST_CASE("a text to a regular file is there as a whole, also over a former one") {
    const Scratch scratch;
    const auto path = scratch.write("r.json", "former");
    OutputFile::write(path, "text");
    CHECK(Scratch::read(path) == "text");
    CHECK(fault_of_output([] { OutputFile::require_writable("/proc/nowhere/r.json"); }) ==
          "cannot write /proc/nowhere/r.json: the folder /proc/nowhere cannot be made: No such "
          "file or directory");
}

TEST_CASE(
    "with sync a file is flushed before it has its name, and then its folder, and a disk that "
    "fails is told") {
    const Scratch scratch;
    const auto root = std::filesystem::canonical(scratch.path()).string(),
               path = root + "/new/r.json";
    flushed.clear();
    OutputFile::write(path, "unsynced");
    CHECK(flushed.empty());
    OutputFile::sync_commits(true);
    {
        OutputFile file(path);
        std::ofstream(file.aside()) << "synced";
        file.commit();
        CHECK(flushed == std::vector{file.aside(), root + "/new"});
    }
    CHECK(Scratch::read(path) == "synced");
    fault_of_disk = EIO;
    const auto fault = fault_of_output([&] { OutputFile::write(path, "lost"); });
    fault_of_disk = 0;
    OutputFile::sync_commits(false);
    CHECK_THAT(fault, Catch::StartsWith("cannot write " + path + ": ") &&
                          Catch::EndsWith(" can't be flushed to the disk: Input/output error"));
    CHECK(Scratch::read(path) == "synced");
    CHECK(std::distance(std::filesystem::directory_iterator(root + "/new"), {}) == 1);
}
