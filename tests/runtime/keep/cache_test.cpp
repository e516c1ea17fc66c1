#include "runtime/keep/cache.h"
#include "runtime/keep/work_folder.h"
#include "tests/runtime/keep/keys.h"
#include "tests/support/scratch.h"
#include "tests/support/toy_nodes.h"

#include <catch2/catch.hpp>

#include <fcntl.h>
#include <sys/stat.h>
#include <memory>
#include <thread>

using namespace fluidcarve;
using namespace fluidcarve::test;
namespace fs = std::filesystem;

namespace {

Payload number(double value) { return Payload(std::make_shared<toy::Number>(value)); }

constexpr std::size_t in_files = 0;  ///< bytes up to which entries are packed: none

std::vector<fs::path> entries(const std::string& folder) {
    std::vector<fs::path> out;
    for (const auto& each : fs::recursive_directory_iterator(folder + "/cache"))
        if (each.is_regular_file()) out.push_back(each.path());
    return out;
}

double value_of(const Payload& payload) { return payload.as<toy::Number>()->value; }

}  // namespace

TEST_CASE("an entry comes back as it was stored") {
    const Scratch scratch;
    const auto registry = toy::registry();
    Cache cache(registry, scratch.path());
    CHECK_FALSE(cache.look(key_of(1)));
    CHECK_FALSE(cache.load(key_of(1)));
    REQUIRE(cache.store(key_of(1), {{"said", "hello"}}, {number(1.5), Payload(), number(2.5)}));
    const auto entry = cache.load(key_of(1));
    REQUIRE(entry);
    CHECK(entry->header["said"] == "hello");
    REQUIRE(entry->outputs.size() == 3);
    CHECK(value_of(entry->outputs[0]) == 1.5);
    CHECK_FALSE(entry->outputs[1]);
    CHECK(value_of(entry->outputs[2]) == 2.5);
    CHECK(cache.look(key_of(1))->at("said") == "hello");
    CHECK(cache.damaged() == 0);
}

TEST_CASE("nothing is kept for a key of nothing, nor without a folder") {
    const Scratch scratch;
    const auto registry = toy::registry();
    Cache cache(registry, scratch.path());
    CHECK(cache.store(Hash{}, {}, {number(1)}));
    CHECK_FALSE(cache.load(Hash{}));
    CHECK_FALSE(fs::exists(scratch / "cache"));
    Cache none(registry, "");
    CHECK(none.store(key_of(1), {}, {number(1)}));
    CHECK_FALSE(none.load(key_of(1)));
}

TEST_CASE("a flipped bit anywhere in an entry is noticed, and the entry goes") {
    const Scratch scratch;
    const auto registry = toy::registry();
    Cache cache(registry, scratch.path(), in_files);
    cache.store(key_of(1), {{"said", "hello"}}, {number(1.5)});
    const auto file = entries(scratch.path()).at(0);
    const auto whole = Scratch::read(file);
    for (std::size_t at = 0; at < whole.size(); ++at)
        for (int bit = 0; bit < 8; ++bit) {
            auto bytes = whole;
            bytes[at] = static_cast<char>(bytes[at] ^ (1 << bit));
            std::ofstream(file, std::ios::binary) << bytes;
            Cache fresh(registry, scratch.path());
            INFO("byte " << at << " bit " << bit);
            CHECK_FALSE(fresh.load(key_of(1)));
            CHECK(fresh.damaged() == 1);
            CHECK_FALSE(fs::exists(file));
        }
}

TEST_CASE("an entry that was cut off or grew is noticed without reading it") {
    const Scratch scratch;
    const auto registry = toy::registry();
    Cache cache(registry, scratch.path(), in_files);
    cache.store(key_of(1), {}, {number(1.5)});
    const auto file = entries(scratch.path()).at(0);
    const auto whole = Scratch::read(file);
    for (std::size_t size = 0; size < whole.size(); ++size) {
        std::ofstream(file, std::ios::binary) << whole.substr(0, size);
        CHECK_FALSE(cache.look(key_of(1)));
    }
    std::ofstream(file, std::ios::binary) << whole << " ";
    CHECK_FALSE(cache.look(key_of(1)));
    std::ofstream(file, std::ios::binary) << whole;
    CHECK(cache.look(key_of(1)));
}

TEST_CASE("a payload type of another version is not read") {
    const Scratch scratch;
    const auto registry = toy::registry();
    Cache(registry, scratch.path()).store(key_of(1), {}, {number(1.5)});
    Registry newer;
    newer.add(payload_type<toy::Number>(
        "number", "A number.", [](const toy::Number&) { return std::uint64_t{8}; },
        {2, [](const toy::Number&, std::ostream&) {},
         [](std::istream&) { return std::make_shared<toy::Number>(0); }}));
    Cache cache(newer, scratch.path());
    CHECK_FALSE(cache.load(key_of(1)));
    CHECK(cache.damaged() == 0);
}

TEST_CASE("where nothing can be written the cache says so once, and goes on without") {
    const auto registry = toy::registry();
    Cache cache(registry, "/proc/nowhere");
    CHECK_FALSE(cache.store(key_of(1), {}, {number(1.5)}));
    CHECK(cache.fault().find("/proc/nowhere") != std::string::npos);
    CHECK_FALSE(cache.store(key_of(2), {}, {number(1.5)}));
}

TEST_CASE("what was used longest ago goes first, until the folder is small enough") {
    const Scratch scratch;
    const auto registry = toy::registry();
    WorkFolder(scratch.path()).make();
    Cache cache(registry, scratch.path(), in_files);
    for (int n = 0; n < 10; ++n) {
        cache.store(key_of(n), {}, {number(n)});
        const timespec times[2] = {{1000 + n, 0}, {1000 + n, 0}};
        utimensat(AT_FDCWD, entries(scratch.path()).at(0).c_str(), times, 0);
        for (const auto& file : entries(scratch.path()))
            if (fs::last_write_time(file) >
                fs::file_time_type::clock::now() - std::chrono::hours(1))
                utimensat(AT_FDCWD, file.c_str(), times, 0);
    }
    REQUIRE(cache.load(key_of(0)));  // used just now
    const auto size = fs::file_size(entries(scratch.path()).at(0));
    const auto trimmed = cache.trim(4 * size);
    CHECK(trimmed.files == 6);
    CHECK(trimmed.left == 4 * size);
    CHECK(cache.look(key_of(0)));
    CHECK(cache.look(key_of(9)));
    CHECK_FALSE(cache.look(key_of(2)));
}

TEST_CASE("what a killed process left half-written goes after a day, and not before") {
    const Scratch scratch;
    const auto registry = toy::registry();
    WorkFolder(scratch.path()).make();
    Cache cache(registry, scratch.path(), in_files);
    cache.store(key_of(1), {}, {number(1)});
    const auto folder = entries(scratch.path()).at(0).parent_path();
    const std::string old = ".old.0123456789abcdef.12.0.part",
                      fresh = ".new.0123456789abcdef.12.1.part";
    for (const auto& name : {old, fresh}) std::ofstream(folder / name) << "half";
    fs::last_write_time(folder / old, fs::file_time_type::clock::now() - std::chrono::hours(25));
    cache.trim(1000000);
    CHECK_FALSE(fs::exists(folder / old));
    CHECK(fs::exists(folder / fresh));
    CHECK(cache.look(key_of(1)));
}

TEST_CASE("many threads that store and load the same entries never meet a damaged one") {
    const Scratch scratch;
    const auto registry = toy::registry();
    std::vector<std::thread> threads;
    std::atomic<std::size_t> damaged{0}, wrong{0};
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&, packed = t % 2 == 0 ? in_files : Cache::small] {
            Cache cache(registry, scratch.path(), packed);
            for (int n = 0; n < 200; ++n) {
                cache.store(key_of(n % 7), {}, {number(n % 7)});
                const auto entry = cache.load(key_of(n % 7));
                if (!entry || value_of(entry->outputs.at(0)) != n % 7) ++wrong;
            }
            damaged += cache.damaged();
        });
    for (auto& thread : threads) thread.join();
    CHECK(damaged == 0);
    CHECK(wrong == 0);
}

TEST_CASE("small entries lie many to a file, a large one in its own, and all are found") {
    const Scratch scratch;
    const auto registry = toy::registry();
    const std::string large(Cache::small, 'x');
    {
        Cache cache(registry, scratch.path());
        for (int n = 0; n < 200; ++n) REQUIRE(cache.store(key_of(n), {{"n", n}}, {number(n)}));
        REQUIRE(cache.store(key_of(200), {{"said", large}}, {number(200)}));
        CHECK(value_of(cache.load(key_of(7))->outputs.at(0)) == 7);
    }
    CHECK(entries(scratch.path()).size() == 2);
    Cache later(registry, scratch.path());
    for (int n = 0; n <= 200; ++n) {
        CHECK(later.look(key_of(n)));
        CHECK(later.intact(key_of(n)));
        CHECK(value_of(later.load(key_of(n))->outputs.at(0)) == n);
    }
    CHECK_FALSE(later.look(key_of(201)));
    CHECK(later.damaged() == 0);
}

TEST_CASE(
    "an entry that has a file keeps it, whichever version wrote it, and one that grows gets one") {
    const Scratch scratch;
    const auto registry = toy::registry();
    Cache(registry, scratch.path(), in_files).store(key_of(1), {}, {number(1)});
    Cache cache(registry, scratch.path());
    CHECK(value_of(cache.load(key_of(1))->outputs.at(0)) == 1);
    cache.store(key_of(1), {}, {number(2)});
    CHECK(entries(scratch.path()).size() == 1);
    CHECK(value_of(cache.load(key_of(1))->outputs.at(0)) == 2);
    cache.store(key_of(2), {}, {number(3)});
    cache.store(key_of(2), {{"said", std::string(Cache::small, 'x')}}, {number(4)});
    CHECK(value_of(cache.load(key_of(2))->outputs.at(0)) == 4);
    CHECK(value_of(Cache(registry, scratch.path()).load(key_of(2))->outputs.at(0)) == 4);
}

TEST_CASE("a damaged entry of a pack is noticed, counted, and stored again, and the others stay") {
    const Scratch scratch;
    const auto registry = toy::registry();
    {
        Cache cache(registry, scratch.path());
        for (int n = 0; n < 3; ++n)
            cache.store(key_of(n), {{"said", "hello " + std::to_string(n)}}, {number(n)});
    }
    const auto file = entries(scratch.path()).at(0);
    auto bytes = Scratch::read(file);
    bytes[bytes.find("hello 1")] = 'j';
    std::ofstream(file, std::ios::binary) << bytes;
    {
        Cache cache(registry, scratch.path());
        CHECK_FALSE(cache.look(key_of(1)));
        CHECK_FALSE(cache.load(key_of(1)));
        CHECK(cache.damaged() == 1);
        CHECK(value_of(cache.load(key_of(0))->outputs.at(0)) == 0);
        CHECK(value_of(cache.load(key_of(2))->outputs.at(0)) == 2);
        cache.store(key_of(1), {}, {number(1)});
        CHECK(value_of(cache.load(key_of(1))->outputs.at(0)) == 1);
    }
    Cache later(registry, scratch.path());
    CHECK(value_of(later.load(key_of(1))->outputs.at(0)) == 1);
    CHECK(later.damaged() == 0);
}

TEST_CASE("packs go as entries do, those that were used longest ago first") {
    const Scratch scratch;
    const auto registry = toy::registry();
    WorkFolder(scratch.path()).make();
    std::vector<std::unique_ptr<Cache>> at_once;  // each has a pack of its own
    for (int n = 0; n < 4; ++n) {
        at_once.push_back(std::make_unique<Cache>(registry, scratch.path()));
        at_once.back()->store(key_of(n), {}, {number(n)});
        for (const auto& file : entries(scratch.path()))
            if (fs::last_write_time(file) >
                fs::file_time_type::clock::now() - std::chrono::hours(1))
                fs::last_write_time(file,
                                    fs::file_time_type::clock::now() - std::chrono::hours(10 - n));
    }
    REQUIRE(entries(scratch.path()).size() == 4);
    Cache cache(registry, scratch.path());
    REQUIRE(cache.load(key_of(0)));  // used just now
    const auto size = fs::file_size(entries(scratch.path()).at(0));
    const auto trimmed = cache.trim(2 * size);
    CHECK(trimmed.files == 2);
    CHECK(trimmed.left == 2 * size);
    for (const int n : {0, 3}) CHECK(cache.look(key_of(n)));
    for (const int n : {1, 2}) CHECK_FALSE(cache.look(key_of(n)));
    CHECK(cache.damaged() == 0);
    CHECK(cache.store(key_of(1), {}, {number(1)}));
    CHECK(cache.look(key_of(1)));
}
