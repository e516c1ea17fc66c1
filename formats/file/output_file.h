#pragma once

#include "carve/base/failure.h"

#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

namespace fluidcarve {

/// A regular file that appears whole or not at all: written under a temporary name in the same
/// folder, then renamed. Without a commit, the destructor removes the temporary file. If the
/// process is killed, the next process that writes into the folder removes it.
class OutputFile {
public:
    /// Makes missing folders.
    /// @throws Failure if the folder can't be written to, or the path is a device or a pipe or
    ///   leads outside of --confine
    explicit OutputFile(std::string path);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    /// The temporary file to write to: in the same folder, with the same extension.
    const std::string& aside() const { return aside_; }
    /// Renames the temporary file to the path. Verify the content first.
    /// @throws Failure if it can't be renamed or, with sync_commits, flushed
    void commit();
    /// Closes a stream into the temporary file, then commits.
    /// @throws Failure also if not all data was written
    void commit(std::ofstream& stream);
    /// Closes a stream into the temporary file.
    /// @throws Failure if not all data was written
    void close(std::ofstream& stream) const;
    /// The failure for a writer that finds its temporary file cut off.
    Failure not_whole() const;

    /// Whether commits wait until the file, and then its name in the folder, are on the disk, so
    /// that files are whole or absent after a power cut, too. Off at first; to be set before files
    /// are written.
    static void sync_commits(bool on);

    /// Inode of the file that this process last renamed to `path`; 0: none.
    static std::uint64_t inode_of(const std::string& path);
    /// Whether a file of this name is a temporary file of any process.
    static bool is_aside(std::string_view name);
    /// Removes the temporary files of all outputs that are not committed. To be called before a
    /// hard exit.
    static void remove_unfinished();

    /// Writes a text: to a regular file whole or not at all, into a device or a pipe, such as
    /// `/dev/stdout`, as it comes.
    /// @throws Failure if that fails
    static void write(const std::string& path, std::string_view text);
    /// @throws Failure if `write` could not even begin
    static void require_writable(const std::string& path);

private:
    std::string path_;
    std::string aside_;
};

}  // namespace fluidcarve
