#include "runtime/keep/file_hashes.h"

#include "carve/base/descriptor.h"
#include "carve/base/failure.h"
#include "formats/file/confinement.h"

#include <tbb/parallel_for.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <vector>

namespace fluidcarve {
namespace {

/// Age in seconds below which a file's hash is not stored: it may change again within the
/// resolution of its times.
constexpr double settled_seconds = 2;

double seconds(const timespec& time) {
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

bool settled(const struct stat& file) {
    const double now =
        std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
    return std::abs(now - seconds(file.st_mtim)) > settled_seconds &&
           std::abs(now - seconds(file.st_ctim)) > settled_seconds;
}

}  // namespace

Hash stamp_of(const struct stat& file) {
    Hasher hash;
    hash.number(file.st_ino).number(static_cast<std::uint64_t>(file.st_size));
    for (const auto& time : {file.st_mtim, file.st_ctim})
        hash.number(static_cast<std::uint64_t>(time.tv_sec))
            .number(static_cast<std::uint64_t>(time.tv_nsec));
    return hash.digest();
}

Hash FileHashes::stored(const Hash& stamp) {
    Hash out;
    const auto bytes = stored_.read(stamp);
    if (!bytes || bytes->size() != sizeof out) return {};
    std::memcpy(&out, bytes->data(), sizeof out);
    stored_.touch(stamp);
    return out;
}

std::optional<FileHashes::Content> FileHashes::find(const std::string& path) {
    const auto& confinement = Confinement::of_program();
    if (!confinement.refusal(path).empty()) return std::nullopt;
    // Without O_NONBLOCK, a pipe would not open before its writer does.
    const Descriptor file{open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)};
    struct stat before {};
    if (file.number < 0 || fstat(file.number, &before) != 0 || !S_ISREG(before.st_mode) ||
        !confinement.refusal_of_open(file.number).empty())
        return std::nullopt;
    const auto stamp = stamp_of(before);
    const auto with = [&](const Hash& hash) {
        return Content{hash, static_cast<std::uint64_t>(before.st_size), before.st_ino};
    };
    if (settled(before))
        if (const auto hash = stored(stamp)) return with(hash);

    Hasher hasher;
    std::vector<char> buffer(std::size_t{1} << 20);
    for (;;) {
        const auto got = read(file.number, buffer.data(), buffer.size());
        if (got < 0) return std::nullopt;
        if (got == 0) break;
        hasher.bytes(buffer.data(), static_cast<std::size_t>(got));
    }
    struct stat after {};
    if (fstat(file.number, &after) != 0 || stamp_of(after) != stamp_of(before)) return std::nullopt;
    const auto hash = hasher.digest();
    if (settled(after)) {
        try {
            stored_.add(stamp, {reinterpret_cast<const char*>(&hash), sizeof hash});
        } catch (const Failure&) {
            // The hash is not stored: the next run reads the file again.
        }
    }
    return with(hash);
}

std::optional<FileHashes::Content> FileHashes::content(const std::string& path) {
    {
        const std::lock_guard lock(mutex_);
        if (const auto found = known_.find(path); found != known_.end()) return found->second;
    }
    return content_now(path);
}

std::optional<FileHashes::Content> FileHashes::content_now(const std::string& path) {
    const auto found = find(path);
    const std::lock_guard lock(mutex_);
    return known_[path] = found;
}

void FileHashes::prepare(const std::vector<std::string>& paths) {
    tbb::parallel_for(std::size_t{0}, paths.size(), [&](std::size_t n) { content(paths[n]); });
}

}  // namespace fluidcarve
