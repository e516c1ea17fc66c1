#pragma once

#include "runtime/keep/content_hash.h"

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// What is in files, as keys. The work folder remembers them by each file's size, times and number, so that a file that nobody
/// touched is not read again, wherever it or its folder was moved.
class FileHashes {
public:
    struct Content {
        Key key;
        std::uint64_t size = 0;
        std::uint64_t number = 0;  ///< of the file (inode)
        Key stamp;                 ///< of size, times and number
    };

    /// @param folder  where they are remembered; empty: nowhere
    explicit FileHashes(std::string folder) : folder_(std::move(folder)) {}

    /// Nothing if the file can't be read. Read once; what happens to the file later does not matter to this object.
    std::optional<Content> of(const std::string& path);
    /// Whether the file is no longer the one whose content is known; of one that could not be read nothing is known.
    bool changed(const std::string& path);
    /// As the file is now.
    std::optional<Content> anew(const std::string& path);
    /// Looks at many files, several at once, so that `of` knows them.
    void prepare(const std::vector<std::string>& paths);

private:
    std::optional<Content> find(const std::string& path) const;

    const std::string folder_;
    std::mutex mutex_;
    std::map<std::string, std::optional<Content>> known_;
};

}  // namespace fluidcarve
