#pragma once

#include "formats/file/content_hash.h"

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace fluidcarve {

/// Sets `first_fault` to "cannot read <path>: <the system's message>", if it is empty and the error
/// is neither 0 nor that of a missing file.
/// @param error  of errno
void note_read_fault(std::string& first_fault, const std::string& path, int error);

/// Small records of a folder, found by their keys. Many records lie in one file, a pack, so that a
/// sequence of thousands of frames makes a few files, not one per record. Any number of processes
/// may share the folder without locks: only one at a time appends to a pack, and readers accept a
/// record only if its head and its end are complete. So a process that is killed leaves whole
/// records, or none.
///
/// A pack is called `HEX.open` while a process appends to it, then `HEX.pack`, with 32 random
/// digits. A process that appends continues a pack that is not full, which it claims by renaming
/// it. A pack that a killed process left open is only read. Thread-safe.
class Packs {
public:
    /// Size in bytes from which on nothing is appended to a pack.
    static constexpr std::uint64_t full = std::uint64_t{16} << 20;

    /// @param folder  where the packs are; empty: nothing is kept
    explicit Packs(std::string folder) : folder_(std::move(folder)) {}
    ~Packs();
    Packs(const Packs&) = delete;
    Packs& operator=(const Packs&) = delete;

    /// The newest record of a key, with every byte intact; nothing if there is none, or it is
    /// damaged. Records that other processes append after the first call may stay unseen.
    std::optional<std::vector<char>> read(const Hash& key);
    /// Makes the next call find what other processes have appended since. This process then
    /// appends to another pack.
    void look_again();
    /// Appends a record, which takes the place of earlier ones of its key.
    /// @throws Failure if it can't be written
    void add(const Hash& key, std::span<const char> bytes);
    /// Closes the pack that this process appends to.
    /// @throws Failure if the system has lost a part of it
    void finish();
    /// Treats the record of a key as missing until another is added.
    void drop(const Hash& key);
    /// Marks the pack with the record of a key as used now, once for each pack.
    void touch(const Hash& key);
    /// Number of damaged records that `read` found.
    std::size_t damaged() const;
    /// Why existing records may not be found: the first error of the system, with the path. Empty:
    /// none.
    std::string read_fault() const;

    /// Whether a file of this name is a pack, if it begins as one.
    static bool is_name(std::string_view name);
    /// Whether a file begins as a pack does.
    static bool is_pack(const std::filesystem::path& file);

private:
    struct Pack {
        std::string name;       ///< 32 digits
        std::uint64_t end = 0;  ///< bytes up to the end of the last known record
        bool touched = false;
    };
    /// Where the newest record of a key is.
    struct Place {
        std::size_t pack = 0;
        std::uint64_t offset = 0, size = 0;  ///< bytes; a size of 0: it was dropped
        std::uint64_t written = 0;  ///< ns since 1970, and later than the record that it replaced
        Hash sum;                   ///< checksum
    };

    struct HashOfKey {
        std::size_t operator()(const Hash& key) const { return key.low; }
    };

    std::string path_of(const Pack& pack, const char* ending) const {
        return folder_ + "/" + pack.name + ending;
    }
    /// Finds the records of all packs, at the first call.
    void scan();
    /// Finds the records of an open pack from its known end on.
    void scan(std::size_t pack, int file);
    /// Opens a pack that may just be renamed. @return below 0: the error, -ENOENT if it is gone
    int open_pack(const Pack& pack) const;
    /// Finds a pack to append to, or makes one. @throws Failure
    void begin_own();
    bool claim(std::size_t pack);
    bool end_own();

    const std::string folder_;
    mutable std::mutex mutex_;
    bool scanned_ = false;
    std::vector<Pack> packs_;
    std::unordered_map<Hash, Place, HashOfKey> places_;
    std::size_t own_ = 0;  ///< the pack that this process appends to
    int own_file_ = -1;    ///< below 0: none
    std::size_t damaged_ = 0;
    std::string read_fault_;
};

}  // namespace fluidcarve
