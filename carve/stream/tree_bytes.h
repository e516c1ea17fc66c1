#pragma once

#include <fmt/format.h>
#include <openvdb/Metadata.h>
#include <openvdb/io/Compression.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace fluidcarve {

/// A read position in the bytes of a file. All functions throw std::runtime_error instead of
/// reading beyond the end.
class TreeBytes {
public:
    explicit TreeBytes(std::span<const char> bytes) : bytes_(bytes) {}

    std::uint64_t left() const { return bytes_.size() - at_; }
    void require(bool sound, std::string_view fault) const {
        if (!sound)
            throw std::runtime_error(fmt::format("{} (at byte {} of its part)", fault, at_));
    }
    std::span<const char> take(std::uint64_t size) {
        require(size <= left(), "it ends too early");
        const auto out = bytes_.subspan(at_, size);
        at_ += size;
        return out;
    }
    void skip(std::uint64_t size) { take(size); }
    template <class T>
    T number() {
        T out;
        std::memcpy(&out, take(sizeof out).data(), sizeof out);
        return out;
    }
    /// Reads a text, which follows its 32-bit length.
    std::string text() {
        const auto chars = take(number<std::uint32_t>());
        return {chars.begin(), chars.end()};
    }

    /// Skips `size` bytes of values as OpenVDB's readData() reads them.
    /// @param compression  OpenVDB's flags
    void skip_data(std::uint64_t size, std::uint32_t compression) {
        const bool blosc = compression & openvdb::io::COMPRESS_BLOSC;
        if (!blosc && !(compression & openvdb::io::COMPRESS_ZIP)) return skip(size);
        const auto length = number<std::int64_t>();
        if (length <= 0) {
            require(static_cast<std::uint64_t>(0) - static_cast<std::uint64_t>(length) == size,
                    "a chunk of values has a wrong length");
            return skip(size);
        }
        const auto chunk = take(static_cast<std::uint64_t>(length));
        if (blosc) check_blosc(chunk, size);
    }
    /// Checks the header of blosc's data, which blosc itself trusts.
    /// @param size  bytes of the values
    void check_blosc(std::span<const char> chunk, std::uint64_t size) const {
        // Version, version of the codec, flags, bytes of a value; then bytes of the values, of a
        // block, of the chunk.
        constexpr std::size_t header = 16, values_at = 4, chunk_at = 12;
        const auto stated = [&](std::size_t at) {
            std::uint32_t out;
            std::memcpy(&out, chunk.data() + at, sizeof out);
            return out;
        };
        require(
            chunk.size() >= header && stated(values_at) == size && stated(chunk_at) == chunk.size(),
            "compressed values have a wrong length");
    }

private:
    std::span<const char> bytes_;
    std::size_t at_ = 0;
};

}  // namespace fluidcarve
