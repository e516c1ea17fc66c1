#include "formats/file/input_file.h"
#include "tests/support/scratch.h"

#include <catch2/catch.hpp>

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/vfs.h>
#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <thread>
#include <vector>

using namespace fluidcarve;

namespace {

template <class Call>
std::string fault_of_input(const Call& call) {
    try {
        call();
    } catch (const Unreadable& unreadable) {
        CHECK(unreadable.kind == Failure::Kind::input);
        CHECK(std::string(unreadable.what()).ends_with(" " + unreadable.fault));
        return unreadable.fault;
    }
    return "";
}

std::string fault_of_path(const std::string& path, FileUse use = {.what = "a song"}) {
    return fault_of_input([&] { const InputFile file(path, use); });
}

/// Share of a file's pages that the system holds in memory.
double cached_share(const std::string& path, std::size_t bytes) {
    const int file = open(path.c_str(), O_RDONLY);
    void* const at = mmap(nullptr, bytes, PROT_READ, MAP_SHARED, file, 0);
    std::vector<unsigned char> pages((bytes + 4095) / 4096);
    mincore(at, bytes, pages.data());
    munmap(at, bytes);
    close(file);
    return static_cast<double>(
               std::ranges::count_if(pages, [](unsigned char page) { return (page & 1) != 0; })) /
           static_cast<double>(pages.size());
}

/// Advises until the system holds that share of a file. The system may pass over an advice when
/// it is busy, so this asks again, for 10 s.
bool advice_leads_to(const std::string& path, InputFile::Advice advice, double share,
                     std::size_t bytes) {
    for (int n = 0; n < 100; ++n) {
        InputFile(path, {.what = "a song"}).advise(advice);
        std::this_thread::sleep_for(std::chrono::milliseconds(n == 0 ? 10 : 100));
        if (cached_share(path, bytes) == share) return true;
    }
    return false;
}

}  // namespace

TEST_CASE("a file is read whole, from its head, or in pieces") {
    const Scratch scratch;
    const InputFile file(scratch.write("a.txt", "all of it"), {.what = "a song"});
    CHECK(file.size() == 9);
    CHECK(file.whole() == "all of it");
    CHECK(file.head(3) == "all");
    CHECK(file.head(99) == "all of it");
    std::string piece(2, '\0');
    file.read(4, piece.data(), piece.size());
    CHECK(piece == "of");
    CHECK(InputFile(scratch.write("empty", ""), {.what = "a song"}).whole().empty());
}

TEST_CASE("what is no regular file is refused at once, and said to be what it is") {
    const Scratch scratch;
    CHECK(fault_of_path(scratch / "none") == "does not exist");
    CHECK(fault_of_path(scratch.write("a.txt", "") + "/none") == "does not exist");
    CHECK(fault_of_path(scratch.path()) == "is a folder");
    CHECK(fault_of_path(scratch.path(), {.what = "a song", .folder = "is no song"}) ==
          "is no song");

    const auto pipe = scratch / "pipe";
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    std::filesystem::create_symlink("/dev/zero", scratch / "link");
    for (const auto& path : {pipe, std::string("/dev/zero"), scratch / "link"})
        CHECK(fault_of_path(path) == "is a pipe or a device; a song is read from a regular file");

    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const auto socket_path = scratch / "socket";
    REQUIRE(socket_path.size() < sizeof address.sun_path);
    std::strcpy(address.sun_path, socket_path.c_str());
    const int plug = socket(AF_UNIX, SOCK_STREAM, 0);
    REQUIRE(bind(plug, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    CHECK(fault_of_path(socket_path) ==
          "is a socket or a device; a song is read from a regular file");
    close(plug);
}

TEST_CASE("a file beyond its limit is refused before it is read") {
    const Scratch scratch;
    const auto path = scratch.write("large", "");
    constexpr std::uint64_t most = std::uint64_t{3} << 20;
    std::filesystem::resize_file(path, most);
    CHECK(fault_of_path(path, {.what = "a song", .most = most}) == "");
    std::filesystem::resize_file(path, most + 1);
    CHECK(fault_of_path(path, {.what = "a song", .most = most}) ==
          "has 3145729 bytes; a song has at most 3 MiB");
}

TEST_CASE("a file that grows or shrinks while it is read, and a disk that fails, are told") {
    const Scratch scratch;
    const auto path = scratch.write("a.txt", "all of it");
    const InputFile file(path, {.what = "a song"});
    std::filesystem::resize_file(path, 10);
    CHECK(fault_of_input([&] { file.whole(); }) ==
          "had 9 bytes when it was opened and has 10 now; read it again when its writer is done");
    std::filesystem::resize_file(path, 4);
    CHECK(fault_of_input([&] { file.whole(); }) ==
          "had 9 bytes when it was opened and has 4 now; read it again when its writer is done");
    CHECK(file.head(99) == "all ");

    // No process has memory at address 0: to read there fails as a damaged disk does.
    CHECK(fault_of_input([] { InputFile("/proc/self/mem", {.what = "a song"}).head(1); }) ==
          "can't be read at byte 0: Input/output error; copy it again");
}

TEST_CASE("the system reads a file ahead, or drops it, as it is advised") {
    constexpr std::size_t bytes = 600'000;  // more than Linux reads at one request
    const Scratch scratch;
    const auto path = scratch.write("a.txt", std::string(bytes, 'x'));
    const int file = open(path.c_str(), O_RDONLY);
    struct statfs where {};
    fstatfs(file, &where);
    fsync(file);
    close(file);
    if (where.f_type == TMPFS_MAGIC) {
        WARN("the scratch folder lies in memory: nothing to see");
        return;
    }
    CHECK(advice_leads_to(path, InputFile::Advice::over, 0, bytes));
    CHECK(advice_leads_to(path, InputFile::Advice::soon, 1, bytes));
    CHECK(advice_leads_to(path, InputFile::Advice::over, 0, bytes));
}
