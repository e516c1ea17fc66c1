#pragma once

#include "carve/base/failure.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace fluidcarve {

/// A path that leads to no regular file, or a file that can't be read.
class Unreadable : public Failure {
public:
    Unreadable(const std::string& path, std::string fault)
        : Failure(path + " " + fault, Kind::input), fault(std::move(fault)) {}
    std::string fault;  ///< the message without the path: "does not exist"
};

/// How a file is read.
struct FileUse {
    static constexpr auto any_size = ~std::uint64_t{0};

    std::string_view what;                    ///< for messages: "a mesh"
    std::uint64_t most = any_size;            ///< bytes that the file may hold
    std::string_view folder = "is a folder";  ///< the fault of a path that leads to a folder
    bool anywhere = false;                    ///< also outside of --confine: the user named it
};

/// A regular file, open for reading. Nothing else is opened: a pipe would keep the program waiting
/// for its writer, a device may have no end.
class InputFile {
public:
    /// @throws Unreadable if the path leads to no regular file or outside of --confine, or the file
    ///   can't be opened or is too large
    InputFile(std::string path, const FileUse& use);
    ~InputFile();
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;

    const std::string& path() const { return path_; }
    /// The path for a library that opens the file by itself. In a confined program it leads to
    /// this open file, as long as this object lives.
    std::string path_to_open() const;
    /// Bytes that the file held when it was opened.
    std::uint64_t size() const { return size_; }

    /// The first bytes: `most`, or all if the file is shorter. @throws Unreadable if the disk fails
    std::string head(std::size_t most) const;
    /// All bytes. @throws Unreadable if the disk fails, or the file changes its size
    std::string whole() const;
    /// Reads `bytes` bytes from `at` on.
    /// @throws Unreadable if the disk fails, or the file has become too short
    void read(std::uint64_t at, char* into, std::size_t bytes) const;
    /// @throws Unreadable if the file holds more or less bytes than when it was opened
    void require_same_size() const;

    enum class Advice { soon, over };
    /// Tells the system to read the whole file ahead (soon), or to drop it from the cache (over).
    void advise(Advice advice) const;

private:
    /// @return the bytes read; fewer than `bytes` at the end of the file
    std::size_t read_some(std::uint64_t at, char* into, std::size_t bytes) const;
    [[noreturn]] void changed(std::uint64_t now) const;

    std::string path_;
    std::uint64_t size_ = 0;
    int file_ = -1;
};

/// The text of a file that this program writes for itself, such as a record in a work folder.
/// Empty if the file can't be read, is not a regular file, is larger than any of ours, or lies
/// outside of --confine.
std::string text_of_own_file(const std::string& path);
/// Whether a path leads to a readable regular file that begins with `bytes`.
bool begins_with(const std::string& path, std::string_view bytes);

}  // namespace fluidcarve
