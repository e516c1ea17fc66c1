#include "graph/output_file.h"

#include "graph/text/problem.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>
#include <filesystem>
#include <fstream>
#include <thread>

using namespace fluidcarve;

TEST_CASE("what a killed run of the same process number left aside does not stop the next") {
    const Scratch scratch;
    for (int serial = 0; serial < 100; ++serial) scratch.write(".o." + std::to_string(getpid()) + "." + std::to_string(serial) + ".part.txt", "old");
    OutputFile file(scratch / "o.txt");
    std::ofstream(file.aside()) << "new";
    file.commit();
    CHECK(Scratch::read(scratch / "o.txt") == "new");
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
              "cannot write " + path + ": it is a device or a pipe, which a file must not replace; name a regular file");
    CHECK(fault_of_output([&] { OutputFile::write("/dev/null", "text"); }) == "");
    CHECK(fault_of_output([&] { OutputFile::write("/dev/full", "text"); }) == "cannot write /dev/full: No space left on device");
    CHECK(fault_of_output([&] { OutputFile::write(pipe, "text"); }) == "cannot write " + pipe + ": nobody reads this pipe");
    CHECK(std::filesystem::is_fifo(pipe));
    CHECK(std::filesystem::is_character_file(link));

    std::string read;
    std::thread reader([&] { read = Scratch::read(pipe); });
    while (!fault_of_output([&] { OutputFile::write(pipe, "text"); }).empty()) std::this_thread::yield();
    reader.join();
    CHECK(read == "text");
}

TEST_CASE("a text to a regular file is there as a whole, also over a former one") {
    const Scratch scratch;
    const auto path = scratch.write("r.json", "former");
    OutputFile::write(path, "text");
    CHECK(Scratch::read(path) == "text");
    CHECK(fault_of_output([] { OutputFile::require_writable("/proc/nowhere/r.json"); }) ==
          "cannot write /proc/nowhere/r.json: the folder /proc/nowhere cannot be made: No such file or directory");
}
