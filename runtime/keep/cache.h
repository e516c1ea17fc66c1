#pragma once

#include "formats/file/content_hash.h"
#include "graph/types/registry.h"
#include "runtime/keep/packs.h"

#include <nlohmann/json.hpp>

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// The entries of a work folder, found by their keys alone: the cache knows files, but no nodes
/// (Store). A large entry is a file, named by its key. It is written to a temporary file with a
/// checksum and then renamed. Small entries lie many to a file (Packs). So any number of processes,
/// on one machine or several, may share a folder without locks; they may compute the same result
/// twice, but never damage an entry.
///
/// An entry has a header, a JSON object set by the caller, and perhaps payloads. `store` adds
/// {"outputs": [...]} to the header of an entry with payloads.
class Cache {
public:
    struct Entry {
        nlohmann::ordered_json header;
        std::vector<Payload> outputs;  ///< null payloads stay null
    };

    static constexpr std::size_t small = std::size_t{64} << 10;

    /// @param folder  the work folder; empty: the cache is off
    /// @param packed  bytes up to which an entry lies in a pack, unless it has a file already
    Cache(const Registry& registry, std::string folder, std::size_t packed = small);

    bool on() const { return !folder_.empty(); }
    const Registry& registry() const { return registry_; }
    /// Reads only the header of an entry. Nothing if there is no entry, or its header or file size
    /// is damaged.
    std::optional<nlohmann::ordered_json> look(const Hash& key) const;
    /// Makes later calls find what other processes have stored meanwhile.
    void look_again();
    /// Marks an entry as used now, for `trim`.
    void touch(const Hash& key) const;
    /// Reads an entry and checks every byte. Nothing if there is no entry, or it is damaged; a
    /// damaged entry is removed, or no longer found in its pack.
    std::optional<Entry> load(const Hash& key);
    /// Whether there is an entry with every byte intact; a damaged entry is removed.
    bool intact(const Hash& key);
    /// Writes an entry.
    /// @return false if it can't be written; later calls then store nothing, and `fault` says why
    bool store(const Hash& key, nlohmann::ordered_json header, const std::vector<Payload>& outputs);
    /// Call it after the last store. Data that the system has lost becomes a fault.
    void finish();
    std::string fault() const;
    /// Why existing entries may not be found: the first error of the system, with the path. Empty:
    /// none.
    std::string read_fault() const;
    /// Number of damaged entries found so far.
    std::size_t damaged() const { return damaged_ + packs_.damaged(); }

    /// The result of `trim`.
    struct Trimmed {
        std::size_t files = 0;              ///< entries and packs
        std::uint64_t bytes = 0, left = 0;  ///< bytes of removed files, and of those that remain
    };
    /// Removes the least recently used entries, a pack as one, until at most `most_bytes` are
    /// left, and what is outdated (WorkFolder). Removes nothing from a folder that is not a work
    /// folder of fluidcarve.
    Trimmed trim(std::uint64_t most_bytes) const;

private:
    struct Read {
        nlohmann::ordered_json header;
        std::vector<char> bytes;  ///< the whole entry
        std::size_t body = 0;     ///< offset of the outputs in `bytes`
    };
    std::string path_of(const Hash& key) const;
    /// Reads a whole entry and checks every byte; a damaged entry is removed.
    std::optional<Read> read(const Hash& key);
    void remove_damaged(const Hash& key);
    /// Records an error of the system. Ignores 0 and missing files.
    void note(const Hash& key, int error) const;

    const Registry& registry_;
    const std::string work_folder_, folder_;
    const std::size_t packed_;
    mutable Packs packs_;
    mutable std::mutex mutex_;
    std::string fault_;
    mutable std::string read_fault_;
    std::atomic<std::size_t> damaged_{0};
};

}  // namespace fluidcarve
