#include "formats/file/output_file.h"

#include "carve/base/failure.h"
#include "formats/file/confinement.h"
#include "formats/file/full_path.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>

namespace fluidcarve {
namespace {

namespace fs = std::filesystem;

std::mutex unfinished_mutex;
std::set<std::string> unfinished;

std::atomic<bool> synced{false};

std::map<std::string, std::uint64_t> committed;  ///< path to inode of the file renamed to it

/// Identifies the boot and PID namespace, within which a process id is unique: 16 hex digits.
const std::string& realm() {
    static const std::string name = [] {
        std::string boot;
        std::ifstream("/proc/sys/kernel/random/boot_id") >> boot;
        std::error_code error;
        return fmt::format(
            "{:016x}",
            std::hash<std::string>()(boot + fs::read_symlink("/proc/self/ns/pid", error).string()));
    }();
    return name;
}

fs::path folder_of(const fs::path& file) {
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// The name of a temporary file: `.STEM.REALM.PROCESS.SERIAL.part[.EXTENSION]`.
/// The stem is cut if the name would be too long for a file.
std::string aside_name(const fs::path& target, unsigned serial) {
    constexpr std::size_t most = 255;  // bytes
    const auto rest =
        fmt::format(".{}.{}.{}.part{}", realm(), getpid(), serial, target.extension().string());
    return "." + target.stem().string().substr(0, most - 1 - std::min(rest.size(), most - 1)) +
           rest;
}

/// The process that a temporary file is named after.
struct Owner {
    std::string realm;
    int process = 0;  ///< 0: impossible process
};

/// Reads what aside_name() wrote; nothing for any other name.
std::optional<Owner> owner_of(std::string_view name) {
    const auto all = [](std::string_view text, std::string_view characters) {
        return !text.empty() && text.find_first_not_of(characters) == std::string_view::npos;
    };
    // Without and with an extension, which may itself be ".part".
    for (auto rest : {name, name.substr(0, name.rfind('.'))}) {
        const auto last = [&rest] {
            const auto dot = rest.rfind('.');
            const auto out = rest.substr(dot + 1);
            rest = rest.substr(0, dot);
            return out;
        };
        if (last() != "part") continue;
        const auto serial = last(), process = last(), realm = last();
        if (!rest.starts_with('.') || !all(serial, "0123456789") || !all(process, "0123456789") ||
            realm.size() != 16 || !all(realm, "0123456789abcdef"))
            continue;
        Owner out{std::string(realm)};
        std::from_chars(process.data(), process.data() + process.size(), out.process);
        return out;
    }
    return std::nullopt;
}

/// Removes temporary files of killed processes from a folder, once per folder. Only files of this
/// realm, whose process is gone.
void remove_orphans(const fs::path& folder) {
    static std::set<fs::path> seen;
    if (!seen.insert(folder).second) return;
    std::error_code error;
    for (fs::directory_iterator each(folder, error), end; !error && each != end;
         each.increment(error)) {
        const auto owner = owner_of(each->path().filename().string());
        if (!owner || owner->realm != realm() || owner->process == 0) continue;
        std::error_code ignored;
        if (kill(owner->process, 0) != 0 && errno == ESRCH) fs::remove(each->path(), ignored);
    }
}

/// Whether a path names a device or a pipe: by its kind, or by its place, such as `/dev/stdout`
/// that leads to a file.
bool is_stream(const fs::path& path) {
    std::error_code error;
    const auto kind = fs::status(path, error).type();
    if (kind == fs::file_type::character || kind == fs::file_type::fifo ||
        kind == fs::file_type::block || kind == fs::file_type::socket)
        return true;
    if (kind == fs::file_type::not_found) return false;
    const auto place = full_path(path).string();
    const auto target =
        fs::is_symlink(path, error) ? fs::read_symlink(path, error).string() : std::string();
    return place.starts_with("/proc/") || place.starts_with("/dev/fd/") ||
           target.starts_with("/proc/");
}

Failure refused(const std::string& path, const std::string& refusal) {
    return Failure(fmt::format("cannot write {}: it {}", path, refusal));
}

/// @throws Failure if --confine forbids a path
void require_allowed(const std::string& path) {
    if (const auto refusal = Confinement::of_program().refusal(path); !refusal.empty())
        throw refused(path, refusal);
}

/// Waits until a file or a folder is on the disk.
/// @param target  the output, for messages
/// @throws Failure if the disk does not take it
void flush(const std::string& path, const std::string& target) {
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    int code = file >= 0 && fsync(file) == 0 ? 0 : errno;
    if (file >= 0 && close(file) != 0 && code == 0) code = errno;
    if (code != 0)
        throw Failure(fmt::format("cannot write {}: {} can't be flushed to the disk: {}", target,
                                  path, std::strerror(code)));
}

/// @throws Failure if a device is a disk, which a text would destroy
void require_no_disk(const std::string& path) {
    std::error_code error;
    if (fs::is_block_file(path, error))
        throw Failure(fmt::format("cannot write {}: it is a disk; name a regular file", path));
}

/// Opens a device or a pipe for writing, without waiting for a reader. @throws Failure
int open_stream(const std::string& path) {
    require_allowed(path);
    require_no_disk(path);
    const int file = open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC | O_NONBLOCK);
    if (file < 0)
        throw Failure(
            fmt::format("cannot write {}: {}", path,
                        errno == ENXIO ? "nobody reads this pipe" : std::strerror(errno)));
    fcntl(file, F_SETFL, fcntl(file, F_GETFL) & ~O_NONBLOCK);
    return file;
}

void make_folder(const fs::path& folder, const std::string& path) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error)
        throw Failure(fmt::format("cannot write {}: the folder {} cannot be made: {}", path,
                                  folder.string(), error.message()));
}

/// @throws Failure if what is there already is not to be replaced by a file
void require_replaceable(const std::string& path) {
    std::error_code error;
    if (fs::is_directory(path, error))
        throw Failure(fmt::format("cannot write {}: it is a folder", path));
    if (is_stream(path))
        throw Failure(
            fmt::format("cannot write {}: it is a device or a pipe, which a file must not replace; "
                        "name a regular file",
                        path));
    if (fs::is_symlink(path, error))
        throw Failure(
            fmt::format("cannot write {}: it is a link to {}, which a file must not replace; "
                        "remove the link, or name another path",
                        path, fs::read_symlink(path, error).string()));
}

}  // namespace

void OutputFile::write(const std::string& path, std::string_view text) {
    if (!is_stream(path)) {
        OutputFile file(path);
        std::ofstream out(file.aside(), std::ios::binary);
        out << text;
        return file.commit(out);
    }
    const int file = open_stream(path);
    while (!text.empty()) {
        const auto wrote = ::write(file, text.data(), text.size());
        if (wrote < 0 && errno == EINTR) continue;
        const auto fault = wrote > 0
                               ? std::string()
                               : fmt::format("cannot write {}: {}", path, std::strerror(errno));
        if (wrote <= 0) {
            ::close(file);
            throw Failure(fault);
        }
        text.remove_prefix(static_cast<std::size_t>(wrote));
    }
    if (::close(file) != 0)
        throw Failure(fmt::format("cannot write {}: {}", path, std::strerror(errno)));
}

void OutputFile::require_writable(const std::string& path) {
    // The reader of a pipe would take a trial write for the end.
    if (!is_stream(path)) {
        const OutputFile file(path);
        return;
    }
    require_allowed(path);
    require_no_disk(path);
    if (access(path.c_str(), W_OK) != 0)
        throw Failure(fmt::format("cannot write {}: {}", path, std::strerror(errno)));
}

OutputFile::OutputFile(std::string path) : path_(std::move(path)) {
    static std::atomic<unsigned> serial{0};
    require_allowed(path_);
    const fs::path target(path_);
    const auto folder = folder_of(target);
    make_folder(folder, path_);
    require_replaceable(path_);
    const std::lock_guard lock(unfinished_mutex);
    remove_orphans(folder);
    // Create the file now: permission bits alone do not tell whether the folder can be written to.
    // A killed process with the same id may have left a file of the same name; then try the next.
    int file = -1;
    do {
        aside_ = (folder / aside_name(target, serial++)).string();
        file = open(aside_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    } while (file < 0 && errno == EEXIST);
    if (file < 0)
        throw Failure(fmt::format("cannot write {}: no file can be made in the folder {}: {}",
                                  path_, folder.string(), std::strerror(errno)));
    // A link may have changed since the path was checked.
    const auto refusal = Confinement::of_program().refusal_of_open(file);
    ::close(file);
    if (!refusal.empty()) {
        std::error_code ignored;
        fs::remove(aside_, ignored);
        throw refused(path_, refusal);
    }
    unfinished.insert(aside_);
}

OutputFile::~OutputFile() {
    const std::lock_guard lock(unfinished_mutex);
    if (unfinished.erase(aside_) == 0) return;
    std::error_code ignored;
    fs::remove(aside_, ignored);
}

void OutputFile::commit() {
    require_allowed(path_);
    // A file that replaces another gets its permissions.
    if (struct stat old{}; stat(path_.c_str(), &old) == 0 && S_ISREG(old.st_mode))
        chmod(aside_.c_str(), old.st_mode & 0777);
    if (synced) flush(aside_, path_);
    {
        const std::lock_guard lock(unfinished_mutex);
        std::error_code error;
        struct stat file {};
        if (stat(aside_.c_str(), &file) == 0) committed[path_] = file.st_ino;
        fs::rename(aside_, path_, error);
        if (error) throw Failure(fmt::format("cannot write {}: {}", path_, error.message()));
        unfinished.erase(aside_);
    }
    if (synced) flush(folder_of(path_).string(), path_);
}

void OutputFile::sync_commits(bool on) { synced = on; }

void OutputFile::commit(std::ofstream& stream) {
    close(stream);
    commit();
}

void OutputFile::close(std::ofstream& stream) const {
    const bool whole = stream.good();
    errno = 0;
    stream.close();
    if (whole && !stream && errno != 0)
        throw Failure(fmt::format("cannot write {}: {}", path_, std::strerror(errno)));
    if (!stream) throw not_whole();
}

Failure OutputFile::not_whole() const {
    return Failure(
        fmt::format("cannot write {}: the file did not come out whole; is the disk full?", path_));
}

bool OutputFile::is_aside(std::string_view name) { return owner_of(name).has_value(); }

std::uint64_t OutputFile::inode_of(const std::string& path) {
    const std::lock_guard lock(unfinished_mutex);
    const auto found = committed.find(path);
    return found == committed.end() ? 0 : found->second;
}

void OutputFile::remove_unfinished() {
    const std::lock_guard lock(unfinished_mutex);
    std::error_code ignored;
    for (const auto& path : unfinished) fs::remove(path, ignored);
    unfinished.clear();
}

}  // namespace fluidcarve
