#pragma once

#include "formats/file/content_hash.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>

namespace fluidcarve {

/// The file of `run --manifest` (runtime/README.md), which lists the content of input files. It
/// detects a file that rotted on disk or was replaced, but not a forged one: hashes are those of
/// Hasher. Thread-safe.
class Manifest {
public:
    /// The entry of a file in a manifest.
    struct Entry {
        Hash hash;  ///< of all bytes
        std::uint64_t size = 0;
        bool operator==(const Entry&) const = default;
    };
    using Entries = std::map<std::string, Entry>;  ///< by path: relative to the manifest's folder
                                                   ///< if the file is below it, else absolute

    /// Reads the manifest if there is one.
    /// @throws Failure (input) if it can't be read, or a line is damaged; Failure if there is none
    ///   and none can be written
    explicit Manifest(std::string path);

    /// Compares the content of a file as earlier runs know it.
    /// @throws Failure (input) if the manifest lists another content
    void require(const std::string& file, const Entry& known);
    /// Reads a file and compares it, at the first call for the file.
    /// @throws Failure (input) if it can't be read, or differs from the manifest's entry or, if
    ///   there is none, from what an earlier run knows
    void require(const std::string& file);

    struct Counts {
        std::size_t listed = 0, added = 0;  ///< files
    };
    /// Adds the files that were compared and that the manifest does not list. Other processes may
    /// do so at the same time.
    /// @throws Failure (input) if another process found different content in such a file; Failure
    ///   if the manifest can't be written
    Counts save();

private:
    struct Met {
        Entry entry;
        bool read = false;  ///< in this run
    };
    std::string name_of(const std::string& file) const;
    void compare(const std::string& file, const Entry& now, const Entry& listed) const;

    const std::string path_;
    const Entries listed_;
    std::mutex mutex_;
    std::map<std::string, Met> met_;  ///< by path, as `listed_`
};

}  // namespace fluidcarve
