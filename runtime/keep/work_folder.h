#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// The folder that keeps results between runs. It bears a mark, a file CACHEDIR.TAG, if fluidcarve
/// made it. Nothing is ever removed from a folder without the mark. From a folder with it, only
/// files are removed that fluidcarve wrote, recognised by name and first bytes.
class WorkFolder {
public:
    explicit WorkFolder(std::string path) : path_(std::move(path)) {}

    /// Makes the folder and marks it if it is missing or empty. @throws Failure if it can't be made
    void make() const;
    bool marked() const;
    /// Why the content of the folder is unknown: it, or a part of it, exists and can't be listed.
    /// Empty: it can, or does not exist.
    std::string read_fault() const;
    /// Why fluidcarve must not remove files in the folder, with the remedy; empty: it may, or
    /// there is no folder.
    std::string fault() const;
    /// Why nothing may be kept in the folder: a part of it is a link. Empty: none is.
    std::string link_fault() const;

    /// Why --confine forbids the folder or a part of it, which may be a link, and the remedy, to
    /// follow its path; empty: it does not.
    std::string refusal() const;

    /// A file with a cached result, or a pack of them.
    struct Entry {
        std::filesystem::path path;
        std::filesystem::file_time_type used;
        std::uint64_t size = 0;  ///< bytes
    };
    /// All files with cached results, by their names. Files of another form do not count.
    std::vector<Entry> entries() const;
    /// Packs of hashes of input files that were not used for 30 days, and temporary files of killed
    /// runs that are older than a day.
    std::vector<std::filesystem::path> outdated() const;
    /// Whether a file begins as a cached result or a pack does.
    static bool is_entry(const std::filesystem::path& file);

    /// The files that `clean` removes.
    struct Cleaning {
        /// Only files not used for so long; nothing: all.
        std::optional<std::chrono::seconds> older{};
        bool dry_run = false;  ///< only counts
        /// Only results of runs of this shot (shot_of); results of up to 64 KB stay.
        std::optional<std::string> shot{};
    };
    /// The result of `clean`.
    struct Cleaned {
        std::size_t removed = 0;  ///< files
        std::uint64_t bytes = 0;  ///< of these
        std::size_t kept = 0;     ///< files that are too new
        std::size_t apart = 0;    ///< files of other shots, or of several
        std::size_t left = 0;     ///< foreign files, which stay
    };
    /// Removes files that fluidcarve wrote, and folders that are then empty.
    /// @throws Failure if one can't be removed
    Cleaned clean(const Cleaning& cleaning) const;

private:
    /// All files that fluidcarve wrote, sorted.
    std::vector<std::filesystem::path> own_files() const;
    /// Number of all files but the mark. @throws Failure if a folder can't be read
    std::size_t count_files() const;

    std::string path_;
};

/// The shot that a pipeline carves: the name of its file, without folder and ending. Results are
/// told apart by it.
std::string shot_of(const std::string& pipeline);

}  // namespace fluidcarve
