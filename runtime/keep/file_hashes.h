#pragma once

#include "formats/file/content_hash.h"
#include "runtime/keep/packs.h"

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

struct stat;

namespace fluidcarve {

/// Identifies one state of a file: hash of inode, size and times.
Hash stamp_of(const struct stat& file);

/// Content hashes of files. They are stored in the work folder (Packs) by each file's size, times
/// and inode, so that an unchanged file is not read again, even if it or its folder was moved.
class FileHashes {
public:
    struct Content {
        Hash hash;               ///< of the content
        std::uint64_t size = 0;  ///< bytes
        std::uint64_t inode = 0;
    };

    /// @param folder  where hashes are stored; empty: nowhere
    explicit FileHashes(std::string folder) : stored_(std::move(folder)) {}

    /// The content of a file at the first call for its path; later changes are ignored. Nothing if
    /// the file can't be read.
    std::optional<Content> content(const std::string& path);
    /// The content of the file now. Later calls of `content` return it too.
    std::optional<Content> content_now(const std::string& path);
    /// Calls `content` for many files, in parallel.
    void prepare(const std::vector<std::string>& paths);

private:
    std::optional<Content> find(const std::string& path);
    /// The stored hash of a file in this state; zero if there is none.
    Hash stored(const Hash& stamp);

    Packs stored_;  ///< stamp to hash
    std::mutex mutex_;
    std::map<std::string, std::optional<Content>> known_;
};

}  // namespace fluidcarve
