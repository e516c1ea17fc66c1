#include "runtime/flow/read_ahead.h"
#include "formats/file/input_file.h"
#include "tests/support/scratch.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <functional>
#include <string>
#include <thread>
#include <vector>

using namespace fluidcarve;

namespace {

constexpr std::size_t cold_size = 600'000;  // more than the system reads at one request

/// Waits until a file is on the disk.
void sync(const std::string& path) {
    const int file = open(path.c_str(), O_RDONLY);
    fsync(file);
    close(file);
}

/// A file on the disk that the system does not hold in memory.
std::string cold_file(const Scratch& scratch, const std::string& name) {
    const auto path = scratch.write(name, std::string(cold_size, 'x'));
    sync(path);
    InputFile(path, {"a file"}).advise(InputFile::Use::over);
    return path;
}

/// Share of a file's pages that the system holds.
double held(const std::string& path) {
    const int file = open(path.c_str(), O_RDONLY);
    void* const at = mmap(nullptr, cold_size, PROT_READ, MAP_SHARED, file, 0);
    std::vector<unsigned char> pages((cold_size + 4095) / 4096);
    mincore(at, cold_size, pages.data());
    munmap(at, cold_size);
    close(file);
    return static_cast<double>(
               std::ranges::count_if(pages, [](unsigned char page) { return (page & 1) != 0; })) /
           static_cast<double>(pages.size());
}

/// Waits until something holds; gives up after a while.
bool eventually(const std::function<bool()>& holds) {
    for (int n = 0; n < 1000; ++n) {
        if (holds()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
}

struct Files {
    Scratch scratch;
    std::vector<std::string> paths;
    explicit Files(int count) {
        for (int n = 0; n < count; ++n) paths.push_back(cold_file(scratch, fmt::format("f{}", n)));
    }
    /// Whether the system drops files at all: it keeps those of a folder that lies in memory.
    bool cold() const {
        return std::ranges::all_of(paths, [](const auto& path) { return held(path) == 0; });
    }
};

}  // namespace

TEST_CASE("files of the next frames are read before these begin, and none farther ahead") {
    const Files files(6);
    if (!files.cold()) {
        WARN("the scratch folder lies in memory: nothing to see");
        return;
    }
    const auto& p = files.paths;
    ReadAhead ahead(
        {{{p[0]}, {p[1], "/none/such"}, {p[2]}, {p[3], p[4]}, {p[5]}}, {{}, {}, {}, {}, {}}}, 2,
        std::uint64_t{1} << 30);
    ahead.begin(0);
    CHECK(eventually([&] { return held(p[0]) == 1 && held(p[1]) == 1 && held(p[2]) == 1; }));
    CHECK(held(p[3]) == 0);
    ahead.begin(1);
    ahead.end(0);
    CHECK(eventually([&] { return held(p[3]) == 1 && held(p[4]) == 1; }));
    CHECK(held(p[5]) == 0);
    CHECK(held(p[0]) == 1);
}

TEST_CASE("files that are larger than memory are dropped once no later frame reads them") {
    const Files files(3);
    if (!files.cold()) {
        WARN("the scratch folder lies in memory: nothing to see");
        return;
    }
    const auto& p = files.paths;
    ReadAhead ahead({{{p[0], p[1]}, {p[1]}, {p[2]}}, {{}, {}, {}}}, 3, 2 * cold_size);
    ahead.begin(0);
    REQUIRE(eventually([&] { return held(p[0]) == 1 && held(p[1]) == 1 && held(p[2]) == 1; }));
    ahead.end(0);
    CHECK(eventually([&] { return held(p[0]) == 0; }));
    CHECK(held(p[1]) == 1);
    ahead.end(1);
    CHECK(eventually([&] { return held(p[1]) == 0; }));
    CHECK(held(p[2]) == 1);
}

TEST_CASE("written files are dropped, too, as soon as they are on the disk") {
    const Files files(3);
    if (!files.cold()) {
        WARN("the scratch folder lies in memory: nothing to see");
        return;
    }
    const auto& p = files.paths;
    for (const bool larger : {false, true}) {
        const auto early = files.scratch.write(fmt::format("early {}", larger),
                                               std::string(cold_size, 'x')),
                   late = files.scratch.write(fmt::format("late {}", larger),
                                              std::string(cold_size, 'x'));
        ReadAhead ahead({{{p[0]}, {p[1]}, {p[2]}}, {{early}, {}, {late}}}, 1,
                        (larger ? 2 : 4) * cold_size);
        ahead.begin(0);
        CHECK(eventually([&] { return held(p[0]) == 1 && held(p[1]) == 1; }));
        ahead.end(0);
        if (larger) CHECK(eventually([&] { return held(p[0]) == 0; }));
        sync(early);
        sync(late);
        ahead.begin(1);
        ahead.end(1);
        CHECK(eventually([&] { return held(p[2]) == 1; }));
        CHECK(eventually([&] { return (held(early) == 0) == larger; }));
        CHECK(held(late) == 1);
    }
}

TEST_CASE("nothing is read ahead where frames read no files") {
    ReadAhead ahead({{{}, {}}, {{}, {}}}, 3, 0);
    ahead.begin(0);
    ahead.end(0);
    ReadAhead none({}, 3, 0);
}
