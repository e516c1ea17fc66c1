#include "runtime/keep/packs.h"
#include "carve/base/failure.h"
#include "tests/runtime/keep/keys.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <atomic>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

using namespace fluidcarve;
using namespace fluidcarve::test;
namespace fs = std::filesystem;

namespace {

std::string text_of(int n) {
    return "record " + std::to_string(n) + std::string(static_cast<std::size_t>(n % 7), '.');
}

std::string read(Packs& packs, int n) {
    const auto bytes = packs.read(key_of(n));
    return bytes ? std::string(bytes->begin(), bytes->end()) : "none";
}

std::vector<fs::path> files_of(const std::string& folder) {
    std::vector<fs::path> out;
    if (fs::exists(folder))
        for (const auto& each : fs::directory_iterator(folder)) out.push_back(each.path());
    return out;
}

std::size_t count_of(const std::string& folder, const std::string& ending) {
    const auto files = files_of(folder);
    return static_cast<std::size_t>(std::ranges::count_if(
        files, [&](const fs::path& file) { return file.extension() == ending; }));
}

/// Adds records as another process, which ends as if it was killed, or closes its pack.
void add_elsewhere(const std::string& folder, int first, int last, bool killed) {
    const auto child = fork();
    if (child == 0) {
        auto* const packs = new Packs(folder);
        for (int n = first; n < last; ++n) packs->add(key_of(n), text_of(n));
        if (!killed) delete packs;
        _exit(0);
    }
    waitpid(child, nullptr, 0);
}

}  // namespace

TEST_CASE("records come back, many of them from one file, and the newest of a key") {
    const Scratch scratch;
    const auto folder = scratch / "packs";
    {
        Packs packs(folder);
        CHECK(read(packs, 1) == "none");
        CHECK_FALSE(fs::exists(folder));
        for (int n = 0; n < 500; ++n) packs.add(key_of(n), text_of(n));
        packs.add(key_of(3), std::string("newer"));
        CHECK(count_of(folder, ".open") == 1);
        CHECK(read(packs, 3) == "newer");
    }
    CHECK(files_of(folder).size() == 1);
    CHECK(count_of(folder, ".pack") == 1);
    Packs later(folder);
    for (int n = 0; n < 500; ++n) CHECK(read(later, n) == (n == 3 ? "newer" : text_of(n)));
    CHECK(read(later, 500) == "none");
    later.drop(key_of(4));
    CHECK(read(later, 4) == "none");
    later.add(key_of(4), std::string("again"));
    CHECK(read(later, 4) == "again");
    CHECK(later.damaged() == 0);
    CHECK(files_of(folder).size() == 1);
}

TEST_CASE("the newest record of a key counts, in whatever pack it is") {
    const Scratch scratch;
    Packs first(scratch.path()), second(scratch.path());
    first.add(key_of(1), std::string("first"));
    CHECK(read(second, 1) == "first");
    second.add(key_of(1), std::string("second"));
    CHECK(count_of(scratch.path(), ".open") == 2);
    for (int n = 0; n < 3; ++n) {
        Packs later(scratch.path());
        CHECK(read(later, 1) == "second");
    }
}

TEST_CASE(
    "of a pack that was cut off anywhere, the records before are there, and the others missing") {
    const Scratch scratch;
    {
        Packs packs(scratch.path());
        for (int n = 0; n < 4; ++n) packs.add(key_of(n), text_of(n));
    }
    const auto file = files_of(scratch.path()).at(0);
    const auto whole = Scratch::read(file);
    for (std::size_t size = 1; size < whole.size(); ++size) {
        std::ofstream(file, std::ios::binary) << whole.substr(0, size);
        Packs packs(scratch.path());
        for (int n = 0; n < 4; ++n) {
            const auto end = whole.find(text_of(n)) + text_of(n).size();
            CHECK(read(packs, n) == (end <= size ? text_of(n) : "none"));
        }
        CHECK(packs.damaged() == 0);
    }
    // Nothing is appended behind half a record.
    std::ofstream(file, std::ios::binary) << whole.substr(0, whole.size() - 3);
    {
        Packs packs(scratch.path());
        packs.add(key_of(9), text_of(9));
        CHECK(count_of(scratch.path(), ".open") == 1);
    }
    CHECK(files_of(scratch.path()).size() == 2);
    Packs packs(scratch.path());
    CHECK(read(packs, 9) == text_of(9));
    CHECK(read(packs, 2) == text_of(2));
    CHECK(read(packs, 3) == "none");
}

TEST_CASE(
    "a flipped bit anywhere costs records, but none comes back wrong, and each can be added "
    "again") {
    const Scratch scratch;
    {
        Packs packs(scratch.path());
        for (int n = 0; n < 3; ++n) packs.add(key_of(n), text_of(n));
    }
    const auto file = files_of(scratch.path()).at(0);
    const auto whole = Scratch::read(file);
    for (std::size_t at = 0; at < whole.size(); ++at) {
        auto bytes = whole;
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << at % 8));
        for (const auto& each : files_of(scratch.path())) fs::remove(each);
        std::ofstream(file, std::ios::binary) << bytes;
        INFO("byte " << at);
        {
            Packs packs(scratch.path());
            int lost = 0;
            for (int n = 0; n < 3; ++n) {
                if (read(packs, n) == text_of(n)) continue;
                CHECK(read(packs, n) == "none");
                packs.add(key_of(n), text_of(n));
                ++lost;
            }
            CHECK(lost > 0);
            CHECK(packs.damaged() <= 1);
        }
        Packs later(scratch.path());
        for (int n = 0; n < 3; ++n) CHECK(read(later, n) == text_of(n));
        CHECK(later.damaged() == 0);
    }
}

TEST_CASE("processes that write at once lose nothing, and the next ones go on with their packs") {
    const Scratch scratch;
    constexpr int writers = 4, records = 200;
    for (int round = 0; round < 3; ++round) {
        std::vector<pid_t> children;
        for (int w = 0; w < writers; ++w)
            if (children.push_back(fork()); children.back() == 0) {
                const int first = (round * writers + w) * records;
                for (int part = 0; part < 2; ++part) {
                    Packs packs(scratch.path());
                    for (int n = first + part * records / 2; n < first + (part + 1) * records / 2;
                         ++n) {
                        packs.add(key_of(n), text_of(n));
                        packs.add(key_of(-1 - n % 5), text_of(n % 5));  // of many
                        if (read(packs, n) != text_of(n) ||
                            read(packs, -1 - n % 5) != text_of(n % 5) || packs.damaged() > 0)
                            _exit(1);
                    }
                }
                _exit(0);
            }
        for (const auto child : children) {
            int status = 1;
            waitpid(child, &status, 0);
            CHECK(status == 0);
        }
        CHECK(files_of(scratch.path()).size() <= 2 * writers);
        CHECK(count_of(scratch.path(), ".open") == 0);
    }
    Packs packs(scratch.path());
    for (int n = 0; n < 3 * writers * records; ++n) CHECK(read(packs, n) == text_of(n));
    for (int n = 0; n < 5; ++n) CHECK(read(packs, -1 - n) == text_of(n));
    CHECK(packs.damaged() == 0);
}

TEST_CASE("threads may share the packs") {
    const Scratch scratch;
    Packs packs(scratch.path());
    std::vector<std::thread> threads;
    std::atomic<int> wrong{0};
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            for (int n = t; n < 400; n += 4) {
                packs.add(key_of(n), text_of(n));
                packs.touch(key_of(n));
                wrong += read(packs, n) != text_of(n);
            }
        });
    for (auto& thread : threads) thread.join();
    CHECK(wrong == 0);
    CHECK(files_of(scratch.path()).size() == 1);
}

TEST_CASE("what a killed process wrote is read, and its pack left alone") {
    const Scratch scratch;
    add_elsewhere(scratch.path(), 0, 10, true);
    REQUIRE(count_of(scratch.path(), ".open") == 1);
    const auto left = files_of(scratch.path()).at(0);
    const auto size = fs::file_size(left);
    add_elsewhere(scratch.path(), 10, 20, false);
    CHECK(fs::file_size(left) == size);
    Packs packs(scratch.path());
    for (int n = 0; n < 20; ++n) CHECK(read(packs, n) == text_of(n));
    packs.add(key_of(20), text_of(20));
    CHECK(files_of(scratch.path()).size() == 2);
}

TEST_CASE(
    "a pack that was claimed by a process meanwhile is read under its new name, with what was "
    "appended") {
    const Scratch scratch;
    add_elsewhere(scratch.path(), 0, 10, false);
    Packs packs(scratch.path());
    CHECK(read(packs, 0) == text_of(0));
    add_elsewhere(scratch.path(), 10, 20, false);
    packs.add(key_of(20), text_of(20));  // goes on with the pack, and so sees all of it
    for (int n = 0; n <= 20; ++n) CHECK(read(packs, n) == text_of(n));
    CHECK(files_of(scratch.path()).size() == 1);
}

TEST_CASE("packs may be removed at any time") {
    const Scratch scratch;
    const auto folder = scratch / "packs";
    Packs packs(folder);
    packs.add(key_of(1), text_of(1));
    fs::remove_all(folder);
    CHECK(read(packs, 1) == "none");
    packs.add(key_of(1), text_of(1));
    packs.add(key_of(2), text_of(2));
    CHECK(read(packs, 1) == text_of(1));
    CHECK(files_of(folder).size() == 1);
    CHECK(packs.damaged() == 0);
}

TEST_CASE("a full pack is closed, and another begun") {
    const Scratch scratch;
    Packs packs(scratch.path());
    const std::string large(Packs::full / 2, 'x');
    for (int n = 0; n < 4; ++n) packs.add(key_of(n), large);
    CHECK(count_of(scratch.path(), ".pack") == 2);
    packs.add(key_of(4), large);
    CHECK(files_of(scratch.path()).size() == 3);
}

TEST_CASE("where no pack can be made the fault is told, and files of others are no packs") {
    Packs packs("/proc/nowhere");
    CHECK_THROWS_AS(packs.add(key_of(1), text_of(1)), Failure);
    CHECK(read(packs, 1) == "none");
    const std::string digits(32, 'a');
    for (const auto* const ending : {".pack", ".open"}) CHECK(Packs::is_name(digits + ending));
    for (const auto& name :
         {digits, digits + ".part", digits.substr(1) + ".pack", "smoke" + digits + ".pack",
          digits + ".pack.pack", std::string("g.pack")})
        CHECK_FALSE(Packs::is_name(name));
    const Scratch scratch;
    const auto file = scratch.write(digits + ".pack", "of somebody else");
    CHECK_FALSE(Packs::is_pack(file));
    Packs beside(scratch.path());
    beside.add(key_of(1), text_of(1));
    CHECK(Scratch::read(file) == "of somebody else");
    CHECK(files_of(scratch.path()).size() == 2);
}
