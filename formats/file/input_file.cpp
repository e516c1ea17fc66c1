#include "formats/file/input_file.h"

#include "formats/file/confinement.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>

namespace fluidcarve {
namespace {

/// Why a path could not be opened. @param error  an errno
std::string fault_of_opening(int error, const FileUse& use) {
    if (error == ENOENT || error == ENOTDIR) return "does not exist";
    if (error == ENXIO)
        return fmt::format("is a socket or a device; {} is read from a regular file", use.what);
    return fmt::format("can't be opened: {}", std::strerror(error));
}

/// Why an open file is not read; empty if it is.
std::string fault_of_opened(const struct stat& opened, const FileUse& use) {
    if (S_ISDIR(opened.st_mode)) return std::string(use.folder);
    if (!S_ISREG(opened.st_mode))
        return fmt::format("is a pipe or a device; {} is read from a regular file", use.what);
    if (static_cast<std::uint64_t>(opened.st_size) > use.most)
        return fmt::format("has {} bytes; {} has at most {} MiB", opened.st_size, use.what,
                           use.most >> 20);
    return {};
}

}  // namespace

InputFile::InputFile(std::string path, const FileUse& use) : path_(std::move(path)) {
    const Confinement none;
    const auto& confinement = use.anywhere ? none : Confinement::of_program();
    if (const auto refusal = confinement.refusal(path_); !refusal.empty())
        throw Unreadable(path_, refusal);
    // Without O_NONBLOCK, a pipe would not open before its writer does. It has no effect on
    // regular files.
    do file_ = open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
    while (file_ < 0 && errno == EINTR);
    if (file_ < 0) throw Unreadable(path_, fault_of_opening(errno, use));
    struct stat opened {};
    auto fault =
        fstat(file_, &opened) == 0 ? fault_of_opened(opened, use) : fault_of_opening(errno, use);
    // A link may have changed since the path was checked.
    if (fault.empty()) fault = confinement.refusal_of_open(file_);
    if (!fault.empty()) {
        close(file_);
        throw Unreadable(path_, fault);
    }
    size_ = static_cast<std::uint64_t>(opened.st_size);
}

InputFile::~InputFile() { close(file_); }

std::string InputFile::path_to_open() const {
    return Confinement::of_program().on() ? fmt::format("/proc/self/fd/{}", file_) : path_;
}

std::string InputFile::head(std::size_t most) const {
    std::string out(most, '\0');
    out.resize(read_some(0, out.data(), out.size()));
    return out;
}

std::string InputFile::whole() const {
    std::string out(size_, '\0');
    read(0, out.data(), out.size());
    require_same_size();
    return out;
}

void InputFile::read(std::uint64_t at, char* into, std::size_t bytes) const {
    if (const auto got = read_some(at, into, bytes); got < bytes) changed(at + got);
}

void InputFile::require_same_size() const {
    struct stat now {};
    if (fstat(file_, &now) != 0)
        throw Unreadable(path_, fmt::format("can't be read: {}", std::strerror(errno)));
    if (static_cast<std::uint64_t>(now.st_size) != size_)
        changed(static_cast<std::uint64_t>(now.st_size));
}

void InputFile::advise(Advice advice) const {
    if (advice == Advice::over) {
        posix_fadvise(file_, 0, 0, POSIX_FADV_DONTNEED);
        return;
    }
    // With the default read-ahead of disks, Linux reads no more than this per request.
    constexpr std::uint64_t at_once = 128 * 1024;
    for (std::uint64_t at = 0; at < size_; at += at_once)
        posix_fadvise(file_, static_cast<off_t>(at), at_once, POSIX_FADV_WILLNEED);
}

std::size_t InputFile::read_some(std::uint64_t at, char* into, std::size_t bytes) const {
    std::size_t done = 0;
    while (done < bytes) {
        const auto got = pread(file_, into + done, bytes - done, static_cast<off_t>(at + done));
        if (got == 0) break;
        if (got < 0 && errno == EINTR) continue;
        if (got < 0)
            throw Unreadable(path_, fmt::format("can't be read at byte {}: {}; copy it again",
                                                at + done, std::strerror(errno)));
        done += static_cast<std::size_t>(got);
    }
    return done;
}

std::string text_of_own_file(const std::string& path) {
    constexpr std::uint64_t most = std::uint64_t{1} << 30;
    try {
        return InputFile(path, {.what = "a record", .most = most}).whole();
    } catch (const Failure&) {
        return {};
    }
}

bool begins_with(const std::string& path, std::string_view bytes) {
    try {
        return InputFile(path, {.what = "a record"}).head(bytes.size()) == bytes;
    } catch (const Failure&) {
        return false;
    }
}

void InputFile::changed(std::uint64_t now) const {
    throw Unreadable(
        path_,
        fmt::format(
            "had {} bytes when it was opened and has {} now; read it again when its writer is done",
            size_, now));
}

}  // namespace fluidcarve
