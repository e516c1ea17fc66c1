#pragma once

#include "graph/types/registry.h"
#include "runtime/keep/content_hash.h"

#include <nlohmann/json.hpp>

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// Results in a work folder, a file each, named by their key. Entries are written aside, sealed with a checksum and renamed, so that any
/// number of processes, on one machine or several, may share a folder without a lock: they may do the same work twice, but
/// never spoil it.
///
/// An entry has a header, a JSON object of the caller's: {"outputs": [...]} is added to it where payloads come along.
class Cache {
public:
    struct Entry {
        nlohmann::ordered_json header;
        std::vector<Payload> outputs;  ///< null where there was none
    };

    /// @param folder  the work folder; empty: nothing is kept, nothing found
    Cache(const Registry& registry, std::string folder);

    bool on() const { return !folder_.empty(); }
    const Registry& registry() const { return registry_; }
    /// The header of a whole entry; a damaged one counts as none. What follows the header is not looked at.
    std::optional<nlohmann::ordered_json> look(const Key& key) const;
    /// The entry was of use.
    void touch(const Key& key) const;
    /// The entry, as `store` was given it; nothing if there is none, or if a byte of it is not as it was: then it is removed.
    std::optional<Entry> load(const Key& key);
    /// Whether there is an entry of which every byte is as it was; a damaged one is removed.
    bool whole(const Key& key);
    /// @return false if it could not be written; from then on nothing is stored, and `fault` says why
    bool store(const Key& key, nlohmann::ordered_json header, const std::vector<Payload>& outputs);
    std::string fault() const;
    /// How many entries `load` found damaged.
    std::size_t damaged() const { return damaged_; }

    /// Removes what was used longest ago until at most so many bytes are left, what killed runs left half-written, and what is
    /// remembered of files that nobody asked for in a month.
    struct Trimmed {
        std::size_t entries = 0;
        std::uint64_t bytes = 0, left = 0;
    };
    Trimmed trim(std::uint64_t most_bytes) const;

private:
    struct Read {
        nlohmann::ordered_json header;
        std::vector<char> bytes;  ///< of the file
        std::size_t body = 0;     ///< where the outputs begin
    };
    std::string path_of(const Key& key) const;
    /// The file of an entry, if it is whole; a damaged one is removed.
    std::optional<Read> read(const Key& key);
    void remove_damaged(const Key& key);

    const Registry& registry_;
    const std::string work_folder_, folder_;
    mutable std::mutex mutex_;
    std::string fault_;
    std::atomic<std::size_t> damaged_{0};
};

}  // namespace fluidcarve
