#pragma once

#include <cstdint>
#include <string>

namespace fluidcarve {

/// A file that appears whole or not at all: written aside in its own folder, then renamed.
/// Give up, by an exception or otherwise, and the destructor removes what was written; after a kill, the next process that
/// writes into the folder does.
class OutputFile {
public:
    /// Makes the folder if it is not there. @throws Failure where it can't be written to
    explicit OutputFile(std::string path);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    /// Where to write: beside the path, with the same ending.
    const std::string& aside() const { return aside_; }
    /// Renames the written file to its path. Call it after verifying. @throws Failure
    void commit();

    /// The number (inode) of the file that this process last renamed to a path; 0: none.
    static std::uint64_t number_at(const std::string& path);
    /// Removes the files aside of all outputs not yet committed: the last act before a hard exit.
    static void remove_unfinished();

private:
    std::string path_;
    std::string aside_;
};

}  // namespace fluidcarve
