#include "carve/stream/packed.h"

#include <openvdb/io/Compression.h>

#include <cstring>
#include <sstream>

namespace fluidcarve {

namespace {

/// Highest compression ratio that is possible. A file that claims more is damaged.
constexpr std::size_t most_packed = 4096;

}  // namespace

void write_packed(std::span<const std::uint16_t> numbers, BinaryWriter& to) {
    std::ostringstream packed;
    openvdb::io::bloscToStream(packed, reinterpret_cast<const char*>(numbers.data()),
                               sizeof(std::uint16_t), numbers.size());
    to.text(packed.view());
}

std::vector<std::uint16_t> read_packed(std::size_t count, BinaryReader& from) {
    const auto packed = from.text();
    // The library trusts the stated size: the number of bytes that follow, below 0 if they are not
    // compressed.
    std::int64_t size = 0;
    BinaryReader::require(packed.size() >= sizeof size);
    std::memcpy(&size, packed.data(), sizeof size);
    const auto there = static_cast<std::int64_t>(packed.size() - sizeof size);
    const auto bytes = count * sizeof(std::uint16_t);
    BinaryReader::require(size == there
                              ? bytes / most_packed <= packed.size()
                              : size == -there && bytes == static_cast<std::size_t>(there));
    std::vector<std::uint16_t> out(count);
    std::istringstream in(packed);
    try {
        openvdb::io::bloscFromStream(in, reinterpret_cast<char*>(out.data()), bytes);
    } catch (const openvdb::Exception&) {
        BinaryReader::require(false);
    }
    return out;
}

}  // namespace fluidcarve
