#include "runtime/keep/file_hashes.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <fcntl.h>
#include <sys/stat.h>
#include <chrono>
#include <thread>

using namespace fluidcarve;
namespace fs = std::filesystem;

namespace {

/// As if it had not been touched for an hour, but for the time at which that was said.
void age(const std::string& file) {
    const auto past = std::time(nullptr) - 3600;
    const timespec times[2] = {{past, 0}, {past, 0}};
    utimensat(AT_FDCWD, file.c_str(), times, 0);
}

Hash file_hash(const std::string& file, const std::string& folder = {}) {
    FileHashes files(folder);
    const auto content = files.content(file);
    return content ? content->hash : Hash{};
}

std::size_t remembered(const std::string& folder) {
    std::size_t out = 0;
    if (fs::exists(folder))
        for (const auto& each : fs::recursive_directory_iterator(folder))
            out += each.is_regular_file() ? 1 : 0;
    return out;
}

std::uintmax_t remembered_bytes(const std::string& folder) {
    std::uintmax_t out = 0;
    for (const auto& each : fs::recursive_directory_iterator(folder))
        out += each.is_regular_file() ? each.file_size() : 0;
    return out;
}

}  // namespace

TEST_CASE("files of the same content have the same hash, whatever their names and times") {
    const Scratch scratch;
    const auto a = scratch.write("a", "the same"), b = scratch.write("b", "the same"),
               c = scratch.write("c", "another");
    age(b);
    CHECK(file_hash(a));
    CHECK(file_hash(a) == file_hash(b));
    CHECK(file_hash(a) != file_hash(c));
    CHECK(file_hash(scratch.write("empty", "")));
    CHECK_FALSE(file_hash(scratch / "none"));
    CHECK_FALSE(file_hash(scratch.path()));
    REQUIRE(mkfifo((scratch / "pipe").c_str(), 0600) == 0);
    CHECK_FALSE(file_hash(scratch / "pipe"));
}

TEST_CASE(
    "a file that changed a moment ago is not remembered by its times, since it may change again "
    "unseen") {
    const Scratch scratch;
    const auto file = scratch.write("a", "one"), folder = scratch / "files";
    const auto first = file_hash(file, folder);
    CHECK(remembered(folder) == 0);
    age(file);  // its state was changed just now, whatever its times say
    CHECK(file_hash(file, folder) == first);
    CHECK(remembered(folder) == 0);
}

TEST_CASE(
    "hashes of settled files are stored, all in one file, and read again by their times and "
    "inodes") {
    const Scratch scratch;
    const auto folder = scratch / "files";
    fs::create_directory(scratch / "in");
    std::vector<std::string> all;
    std::vector<Hash> hashes;
    for (int n = 0; n < 50; ++n)
        all.push_back(scratch.write("in/" + std::to_string(n), "content " + std::to_string(n)));
    std::this_thread::sleep_for(std::chrono::milliseconds(2100));  // as long as files count as new
    for (const auto& file : all) hashes.push_back(file_hash(file));
    {
        FileHashes files(folder);
        files.prepare(all);
    }
    CHECK(remembered(folder) == 1);
    const auto before = remembered_bytes(folder);
    fs::rename(scratch / "in", scratch / "moved");
    for (std::size_t n = 0; n < all.size(); ++n)
        CHECK(file_hash(scratch / ("moved/" + std::to_string(n)), folder) == hashes[n]);
    CHECK(remembered_bytes(folder) == before);
}

TEST_CASE("a run knows a file as it first read it, until it asks anew") {
    const Scratch scratch;
    const auto file = scratch.write("a", "one");
    FileHashes files("");
    const auto first = files.content(file)->hash;
    scratch.write("a", "two");
    CHECK(files.content(file)->hash == first);
    CHECK(files.content_now(file)->hash != first);
    CHECK(files.content(file)->hash != first);
    CHECK(files.content(file)->size == 3);
}
