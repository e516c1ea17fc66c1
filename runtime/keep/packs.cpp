#include "runtime/keep/packs.h"

#include "carve/base/descriptor.h"
#include "carve/base/failure.h"
#include "formats/file/input_file.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <random>
#include <utility>

namespace fluidcarve {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view pack_magic{"fluidcarve pack\n", 16};
constexpr auto closed = ".pack", opened = ".open";
constexpr std::size_t name_digits = 32;

/// The head of each record, before its bytes. A pack consists of records.
struct RecordHead {
    std::array<char, 16> magic;
    Hash key;
    std::uint64_t size, written;  ///< as in Packs::Place
    Hash sum;                     ///< of the bytes
    Hash seal;                    ///< checksum of all members before
};
static_assert(sizeof(RecordHead) == 16 + 16 + 8 + 8 + 16 + 16);

Hash sum_of(const void* data, std::size_t size) { return Hasher().bytes(data, size).digest(); }

bool is_whole(const RecordHead& head) {
    return std::string_view(head.magic.data(), head.magic.size()) == pack_magic &&
           head.seal == sum_of(&head, offsetof(RecordHead, seal));
}

std::uint64_t size_of(int file) {
    struct stat about {};
    return fstat(file, &about) == 0 ? static_cast<std::uint64_t>(about.st_size) : 0;
}

std::uint64_t nanoseconds_now() {
    return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                          std::chrono::system_clock::now().time_since_epoch())
                                          .count());
}

std::string random_name() {
    std::random_device random;
    const auto number = [&] { return std::uint64_t{random()} << 32 | random(); };
    return Hash{number(), number() | 1}.text();
}

/// What is thrown if a call of the system failed.
Failure failed_write(const std::string& path) {
    return Failure(fmt::format("cannot write {}: {}", path, std::strerror(errno)));
}

}  // namespace

void note_read_fault(std::string& first_fault, const std::string& path, int error) {
    if (error != 0 && error != ENOENT && first_fault.empty())
        first_fault = fmt::format("cannot read {}: {}", path, std::strerror(error));
}

Packs::~Packs() { end_own(); }

std::optional<std::vector<char>> Packs::read(const Hash& key) {
    std::unique_lock lock(mutex_);
    scan();
    const auto found = places_.find(key);
    if (found == places_.end() || found->second.size == 0) return std::nullopt;
    const auto place = found->second;
    const auto pack = packs_[place.pack];
    lock.unlock();
    const Descriptor file{open_pack(pack)};
    std::vector<char> out(place.size);
    const bool there = file.number >= 0;
    errno = there ? 0 : -file.number;
    if (there && read_at(file.number, place.offset, out.data(), out.size()) &&
        sum_of(out.data(), out.size()) == place.sum)
        return out;
    const int code = errno;
    lock.lock();
    note_read_fault(read_fault_, path_of(pack, closed), code);
    damaged_ += there ? 1 : 0;
    if (auto& now = places_[key]; now.written == place.written) now.size = 0;
    return std::nullopt;
}

void Packs::look_again() {
    const std::lock_guard lock(mutex_);
    end_own();
    packs_.clear();
    places_.clear();
    read_fault_.clear();
    scanned_ = false;
}

void Packs::add(const Hash& key, std::span<const char> bytes) {
    if (folder_.empty() || bytes.empty()) return;
    const std::lock_guard lock(mutex_);
    scan();
    struct stat about {};
    // Another process may have removed the pack.
    if (own_file_ >= 0 && (fstat(own_file_, &about) != 0 || about.st_nlink == 0)) end_own();
    if (own_file_ < 0) begin_own();
    auto& pack = packs_[own_];
    auto& place = places_[key];
    const Place now{own_, pack.end + sizeof(RecordHead), bytes.size(),
                    std::max(nanoseconds_now(), place.written + 1),
                    sum_of(bytes.data(), bytes.size())};
    RecordHead head{{}, key, now.size, now.written, now.sum, {}};
    std::ranges::copy(pack_magic, head.magic.begin());
    head.seal = sum_of(&head, offsetof(RecordHead, seal));
    std::vector<char> record(sizeof head + bytes.size());
    std::memcpy(record.data(), &head, sizeof head);
    std::ranges::copy(bytes, record.begin() + sizeof head);
    if (!write_at(own_file_, pack.end, record.data(), record.size())) {
        const auto failure = failed_write(path_of(pack, opened));
        if (ftruncate(own_file_, static_cast<off_t>(pack.end)) == 0 && pack.end == 0)
            unlink(path_of(pack, opened).c_str());
        end_own();
        throw failure;
    }
    place = now;
    pack.end += record.size();
    if (pack.end >= full && !end_own()) throw failed_write(path_of(pack, opened));
}

void Packs::finish() {
    const std::lock_guard lock(mutex_);
    if (!end_own()) throw failed_write(path_of(packs_[own_], closed));
}

void Packs::drop(const Hash& key) {
    const std::lock_guard lock(mutex_);
    if (const auto found = places_.find(key); found != places_.end()) found->second.size = 0;
}

void Packs::touch(const Hash& key) {
    const std::lock_guard lock(mutex_);
    const auto found = places_.find(key);
    if (found == places_.end() || found->second.size == 0) return;
    auto& pack = packs_[found->second.pack];
    if (std::exchange(pack.touched, true)) return;
    for (const auto* const ending : {closed, opened})
        utimensat(AT_FDCWD, path_of(pack, ending).c_str(), nullptr, 0);
}

std::size_t Packs::damaged() const {
    const std::lock_guard lock(mutex_);
    return damaged_;
}

std::string Packs::read_fault() const {
    const std::lock_guard lock(mutex_);
    return read_fault_;
}

bool Packs::is_name(std::string_view name) {
    const auto digits = name.substr(0, name_digits), ending = name.substr(digits.size());
    return Hash::parse(digits) && (ending == closed || ending == opened);
}

bool Packs::is_pack(const fs::path& file) { return begins_with(file, pack_magic); }

void Packs::scan() {
    if (folder_.empty() || std::exchange(scanned_, true)) return;
    std::error_code error;
    for (fs::directory_iterator each(folder_, error), end; !error && each != end;
         each.increment(error)) {
        const auto name = each->path().filename().string();
        if (!is_name(name)) continue;
        packs_.push_back({name.substr(0, name_digits)});
        const Descriptor file{open_pack(packs_.back())};
        if (file.number >= 0) scan(packs_.size() - 1, file.number);
        else note_read_fault(read_fault_, path_of(packs_.back(), closed), -file.number);
    }
    note_read_fault(read_fault_, folder_, error.value());
}

void Packs::scan(std::size_t n, int file) {
    auto& end = packs_[n].end;
    const auto size = size_of(file);
    RecordHead head{};
    errno = 0;
    while (read_at(file, end, &head, sizeof head) && is_whole(head)) {
        const auto begin = end + sizeof head;
        if (begin > size || head.size > size - begin) return;
        auto& place = places_[head.key];
        if (head.written >= place.written) place = {n, begin, head.size, head.written, head.sum};
        end = begin + head.size;
    }
    note_read_fault(read_fault_, path_of(packs_[n], closed), errno);
}

int Packs::open_pack(const Pack& pack) const {
    int error = ENOENT;
    for (const auto* const ending : {closed, opened, closed}) {
        if (const int file =
                open(path_of(pack, ending).c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
            file >= 0)
            return file;
        if (errno != ENOENT) error = errno;
    }
    return -error;
}

void Packs::begin_own() {
    for (std::size_t n = 0; n < packs_.size(); ++n)
        if (packs_[n].end > 0 && packs_[n].end < full && claim(n)) return;
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error)
        throw Failure(fmt::format("cannot write into {}: the folder cannot be made: {}", folder_,
                                  error.message()));
    Pack pack{random_name()};
    own_file_ = open(path_of(pack, opened).c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (own_file_ < 0) throw failed_write(path_of(pack, opened));
    own_ = packs_.size();
    packs_.push_back(std::move(pack));
}

bool Packs::claim(std::size_t n) {
    const auto free = path_of(packs_[n], closed), mine = path_of(packs_[n], opened);
    if (std::rename(free.c_str(), mine.c_str()) != 0) return false;
    own_file_ = open(mine.c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
    own_ = n;
    // Another process may have appended to it since it was scanned. Nothing is appended behind
    // damaged records.
    if (own_file_ >= 0) scan(n, own_file_);
    const auto size = own_file_ < 0 ? 0 : size_of(own_file_);
    if (size > 0 && size == packs_[n].end && size < full) return true;
    if (own_file_ >= 0) end_own();
    else std::rename(mine.c_str(), free.c_str());
    return false;
}

bool Packs::end_own() {
    if (own_file_ < 0) return true;
    const bool good = close(std::exchange(own_file_, -1)) == 0;
    const int code = errno;
    std::rename(path_of(packs_[own_], opened).c_str(), path_of(packs_[own_], closed).c_str());
    errno = code;
    return good;
}

}  // namespace fluidcarve
