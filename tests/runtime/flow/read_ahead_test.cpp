#include "runtime/flow/read_ahead.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

using namespace fluidcarve;

namespace {

using Files = std::vector<std::string>;

/// What the system was advised, in order.
class Told {
public:
    ReadAhead::Advise advise() {
        return [this](const std::string& path, InputFile::Advice advice) {
            const std::lock_guard lock(mutex_);
            (advice == InputFile::Advice::soon ? soon_ : over_).push_back(path);
            changed_.notify_all();
        };
    }
    /// All files to read soon. Waits until there are so many; gives up after a while.
    Files soon(std::size_t count) { return wait(soon_, count); }
    /// All files to drop. Waits like soon().
    Files over(std::size_t count) { return wait(over_, count); }

private:
    Files wait(const Files& files, std::size_t count) {
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, std::chrono::minutes(1), [&] { return files.size() >= count; });
        return files;
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    Files soon_, over_;
};

constexpr std::uint64_t much = std::uint64_t{1} << 40, none = 0;  ///< memory, bytes

/// A file that is there, so that it has a size.
const std::string there = "CMakeLists.txt";

}  // namespace

TEST_CASE("files of the next frames are read before these begin, and none farther ahead") {
    Told told;
    ReadAhead ahead({{{"a"}, {"b", "c"}, {"d"}, {"e", "f"}, {"g"}}, {{}, {}, {}, {}, {}}}, 2, much,
                    told.advise());
    ahead.begin(0);
    CHECK(told.soon(4) == Files{"a", "b", "c", "d"});
    ahead.begin(1);
    ahead.end(0);
    CHECK(told.soon(6) == Files{"a", "b", "c", "d", "e", "f"});
    CHECK(told.over(0).empty());
}

TEST_CASE("files that are larger than memory are dropped once no later frame reads them") {
    Told told;
    ReadAhead ahead({{{there, "b"}, {"b"}, {"c"}}, {{}, {}, {}}}, 3, none, told.advise());
    ahead.begin(0);
    CHECK(told.soon(4) == Files{there, "b", "b", "c"});
    ahead.end(0);
    CHECK(told.over(1) == Files{there});
    ahead.end(1);
    CHECK(told.over(2) == Files{there, "b"});
    ahead.end(2);
    CHECK(told.over(3) == Files{there, "b", "c"});
}

TEST_CASE("written files are dropped, too, and again while they may not be on the disk") {
    Told told;
    ReadAhead ahead({{{there}, {there}, {there}}, {{"w"}, {}, {"x"}}}, 1, none, told.advise());
    ahead.end(0);
    CHECK(told.over(1) == Files{"w"});
    ahead.end(1);
    CHECK(told.over(2) == Files{"w", "w"});
    ahead.end(2);
    CHECK(told.over(5) == Files{"w", "w", there, "w", "x"});
}

TEST_CASE("files of frames that are done are not read ahead again") {
    Told told;
    ReadAhead ahead({{{"a"}, {"b"}, {"c"}}, {{}, {}, {}}}, 0, much, told.advise());
    ahead.end(1);
    ahead.begin(2);
    CHECK(told.soon(1) == Files{"c"});
}

TEST_CASE("nothing is read ahead where frames read no files") {
    Told told;
    ReadAhead ahead({{{}, {}}, {{}, {}}}, 3, none, told.advise());
    ahead.begin(0);
    ahead.end(0);
    ReadAhead empty({}, 3, none, told.advise());
    CHECK(told.soon(0).empty());
}

TEST_CASE("a file that can't be opened stops no reading ahead") {
    CHECK_NOTHROW(ReadAhead::advise_system("/none/such", InputFile::Advice::soon));
    CHECK_NOTHROW(ReadAhead::advise_system("/none/such", InputFile::Advice::over));
}
