#include "runtime/keep/manifest.h"

#include "carve/base/descriptor.h"
#include "formats/file/confinement.h"
#include "formats/file/full_path.h"
#include "formats/file/input_file.h"
#include "formats/file/output_file.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string_view>
#include <thread>
#include <vector>

namespace fluidcarve {
namespace {

constexpr std::string_view first_line = "# fluidcarve manifest 1: XXH128, bytes, path";
constexpr std::string_view gap = "  ";
constexpr std::size_t hash_digits = 32;
constexpr std::uint64_t most_manifest_bytes = std::uint64_t{1} << 30;
constexpr std::chrono::seconds most_waiting{60};

/// Writes line breaks as `\n` and backslashes as `\\`.
std::string escaped(const std::string& path) {
    std::string out;
    for (const char c : path) {
        if (c == '\n') out += "\\n";
        else if (c == '\\') out += "\\\\";
        else out += c;
    }
    return out;
}

/// Reads what `escaped` wrote.
std::string unescaped(std::string_view text) {
    std::string out;
    for (std::size_t at = 0; at < text.size(); ++at) {
        const bool escape = text[at] == '\\' && at + 1 < text.size();
        if (escape) ++at;
        out += escape && text[at] == 'n' ? '\n' : text[at];
    }
    return out;
}

/// Adds the file of a line to the entries. @return the fault of the line; empty: none
std::string add_line(std::string_view line, Manifest::Entries& entries) {
    const auto hash = Hash::parse(line.substr(0, hash_digits));
    if (!hash) return fmt::format("it does not begin with a hash of {} hex digits", hash_digits);
    line.remove_prefix(hash_digits);
    std::uint64_t size = 0;
    const auto* const end = line.data() + line.size();
    const auto* const begin = line.data() + std::min(line.size(), gap.size());
    const auto [after, error] = std::from_chars(begin, end, size);
    if (!line.starts_with(gap) || error != std::errc())
        return "no number of bytes follows the hash";
    line.remove_prefix(static_cast<std::size_t>(after - line.data()));
    if (!line.starts_with(gap) || line.size() == gap.size())
        return "no path follows the number of bytes";
    const auto path = unescaped(line.substr(gap.size()));
    return entries.try_emplace(path, Manifest::Entry{hash, size}).second
               ? std::string()
               : fmt::format("{} is listed twice", path);
}

/// The entries of a manifest; none if there is no file.
/// @throws Failure (input) if it can't be read, or a line is damaged
Manifest::Entries entries_in(const std::string& path) {
    Manifest::Entries out;
    std::error_code error;
    if (!std::filesystem::exists(path, error) && !error) return out;
    const auto text = InputFile(path, {.what = "a manifest", .most = most_manifest_bytes}).whole();
    std::size_t number = 0;
    for (std::string_view rest = text; !rest.empty() || number == 0;) {
        const auto end = rest.find('\n');
        const auto line = rest.substr(0, end);
        ++number;
        const auto fault = end == std::string_view::npos ? "it is cut off"
                           : number > 1                  ? add_line(line, out)
                           : line == first_line          ? std::string()
                                                : fmt::format("it is not '{}'", first_line);
        if (!fault.empty())
            throw Failure(
                fmt::format(
                    "{}, line {}: {}; restore the manifest, or delete it to begin a new one", path,
                    number, fault),
                Failure::Kind::input);
        rest.remove_prefix(end + 1);
    }
    return out;
}

std::string to_text(const Manifest::Entries& entries) {
    auto out = fmt::format("{}\n", first_line);
    for (const auto& [path, entry] : entries)
        out += fmt::format("{}{}{}{}{}\n", entry.hash.text(), gap, entry.size, gap, escaped(path));
    return out;
}

Manifest::Entry read_entry(const std::string& path) {
    const InputFile file(path, {.what = "an input"});
    Hasher hash;
    std::vector<char> buffer(std::size_t{1} << 20);
    for (std::uint64_t at = 0; at < file.size();) {
        const auto bytes =
            static_cast<std::size_t>(std::min<std::uint64_t>(buffer.size(), file.size() - at));
        file.read(at, buffer.data(), bytes);
        hash.bytes(buffer.data(), bytes);
        at += bytes;
    }
    file.require_same_size();
    return {hash.digest(), file.size()};
}

/// How a file differs from a known entry.
std::string difference(const Manifest::Entry& now, const Manifest::Entry& known) {
    return now.size == known.size ? "its hash differs"
                                  : fmt::format("it has {} bytes and had {}", now.size, known.size);
}

/// Keeps other processes from a file for its lifetime, by a lock on a file beside it. The lock of a
/// killed process is free.
class FileLock {
public:
    explicit FileLock(const std::string& of) : path_(of + ".lock") {
        const auto until = std::chrono::steady_clock::now() + most_waiting;
        while (!take()) {
            if (std::chrono::steady_clock::now() > until)
                throw Failure(fmt::format(
                    "cannot write {}: a process has held {} for {} s; end it, or delete that file",
                    of, path_, most_waiting.count()));
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
    }
    ~FileLock() { unlink(path_.c_str()); }
    FileLock(const FileLock&) = delete;
    FileLock& operator=(const FileLock&) = delete;

private:
    /// @return false if another process has the lock
    bool take() {
        const auto refuse = [this](const std::string& fault) {
            throw Failure(fmt::format("cannot lock {}: {}", path_, fault));
        };
        const auto& confinement = Confinement::of_program();
        if (const auto refusal = confinement.refusal(path_); !refusal.empty())
            refuse("it " + refusal);
        file_.reset(new Descriptor{
            open(path_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666)});
        if (file_->number < 0)
            refuse(errno == ELOOP ? "it is a link; remove it" : std::strerror(errno));
        struct stat locked {
        }, there{};
        // The lock is empty, and removed at the end. A file with content may be foreign.
        if (fstat(file_->number, &locked) != 0 || !S_ISREG(locked.st_mode) || locked.st_size != 0)
            refuse("it is no lock of fluidcarve; remove or rename it");
        if (const auto refusal = confinement.refusal_of_open(file_->number); !refusal.empty())
            refuse("it " + refusal);
        if (flock(file_->number, LOCK_EX | LOCK_NB) != 0) {
            if (errno == EWOULDBLOCK || errno == EINTR) return false;
            throw Failure(fmt::format("cannot lock {}: {}; keep the manifest on a disk with locks",
                                      path_, std::strerror(errno)));
        }
        // The process that had the lock before removed the file, which another may have made again.
        return stat(path_.c_str(), &there) == 0 && locked.st_ino == there.st_ino &&
               locked.st_dev == there.st_dev;
    }

    const std::string path_;
    std::unique_ptr<Descriptor> file_;
};

}  // namespace

Manifest::Manifest(std::string path) : path_(std::move(path)), listed_(entries_in(path_)) {
    std::error_code ignored;
    if (!std::filesystem::exists(path_, ignored)) OutputFile::require_writable(path_);
}

std::string Manifest::name_of(const std::string& file) const {
    const auto full = full_path(file);
    const auto below = full.lexically_relative(full_path(path_).parent_path());
    return below.empty() || *below.begin() == ".." ? full.string() : below.string();
}

void Manifest::compare(const std::string& file, const Entry& now, const Entry& listed) const {
    if (now == listed) return;
    throw Failure(fmt::format("{} is not the file that the manifest {} knows: {}; restore it, or "
                              "delete its line from the manifest to accept it",
                              file, path_, difference(now, listed)),
                  Failure::Kind::input);
}

void Manifest::require(const std::string& file, const Entry& known) {
    const auto name = name_of(file);
    if (const auto listed = listed_.find(name); listed != listed_.end())
        compare(file, known, listed->second);
    const std::lock_guard lock(mutex_);
    met_.try_emplace(name, Met{known, false});
}

void Manifest::require(const std::string& file) {
    const auto name = name_of(file);
    {
        const std::lock_guard lock(mutex_);
        if (const auto met = met_.find(name); met != met_.end() && met->second.read) return;
    }
    const auto now = read_entry(file);
    if (const auto listed = listed_.find(name); listed != listed_.end())
        compare(file, now, listed->second);
    const std::lock_guard lock(mutex_);
    auto& met = met_.try_emplace(name, Met{now, true}).first->second;
    if (met.entry != now)
        throw Failure(fmt::format("{} is not the file that earlier runs knew, though its times are "
                                  "the same: {}; restore it, or copy it anew to accept it",
                                  file, difference(now, met.entry)),
                      Failure::Kind::input);
    met.read = true;
}

Manifest::Counts Manifest::save() {
    const std::lock_guard lock(mutex_);
    Counts out;
    for (const auto& [name, met] : met_) ++(listed_.contains(name) ? out.listed : out.added);
    if (out.added == 0) return out;
    const FileLock alone(path_);
    auto all = entries_in(path_);
    for (const auto& [name, met] : met_)
        compare(name, met.entry, all.try_emplace(name, met.entry).first->second);
    OutputFile::write(path_, to_text(all));
    return out;
}

}  // namespace fluidcarve
