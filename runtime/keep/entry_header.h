#pragma once

#include "formats/file/content_hash.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace fluidcarve {

// Layout of an entry of the cache, in a file or a pack: magic, header size, size of the outputs,
// header checksum, header, outputs, checksum of all before.

inline constexpr std::string_view entry_magic{"fluidcarve 1\n\0\0\0", 16};
inline constexpr std::size_t entry_prefix = 16 + 8 + 8 + 16;  ///< bytes before the header
inline constexpr std::size_t entry_seal = 16;                 ///< bytes of the last checksum

inline Hash entry_checksum(std::span<const char> bytes) {
    return Hasher().bytes(bytes.data(), bytes.size()).digest();
}

template <class T>
T number_at(const char* data) {
    T out;
    std::memcpy(&out, data, sizeof out);
    return out;
}

/// Opens an entry for reading.
/// @return below 0: the error, -ENOENT also if it is not a regular file, or lies outside of
///   --confine
int open_entry(const std::string& path);

/// The header in the first bytes of an entry; nothing if it or the size is wrong.
/// @param size  bytes of the entry
std::optional<nlohmann::ordered_json> entry_header(std::span<const char> bytes, std::uint64_t size);
/// The header of an open file; nothing if the header or the file size is wrong.
/// @param size  set to the file size, bytes
std::optional<nlohmann::ordered_json> entry_header(int file, std::uint64_t& size);
/// The header of a file; nothing if it is no entry.
std::optional<nlohmann::ordered_json> entry_header(const std::string& path);

}  // namespace fluidcarve
