#include "nodes/page/packed.h"

#include "carve/base/failure.h"
#include "graph/text/base64.h"

#include <zlib.h>

#include <bit>
#include <limits>

namespace fluidcarve {

std::string packed(std::span<const std::uint8_t> bytes) {
    if (bytes.size() > std::numeric_limits<uInt>::max())
        throw Failure("a page holds at most 4 GiB of one kind; choose fewer `voxels`");
    z_stream stream{};
    // 16 more than the largest window asks for a gzip header.
    if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, 16 + MAX_WBITS, 9,
                     Z_DEFAULT_STRATEGY) != Z_OK)
        throw Failure("zlib has no memory to compress a page");
    std::vector<unsigned char> out(deflateBound(&stream, static_cast<uLong>(bytes.size())));
    stream.next_in = const_cast<Bytef*>(bytes.data());
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = out.data();
    stream.avail_out = static_cast<uInt>(out.size());
    const bool whole = deflate(&stream, Z_FINISH) == Z_STREAM_END;
    const auto size = static_cast<std::size_t>(stream.total_out);
    deflateEnd(&stream);
    if (!whole) throw Failure("zlib can't compress a page");
    return base64({reinterpret_cast<const char*>(out.data()), size});
}

void append_differences(std::vector<std::uint8_t>& bytes, std::span<const std::uint8_t> values) {
    std::uint8_t last = 0;
    for (const auto value : values) {
        bytes.push_back(static_cast<std::uint8_t>(value - last));
        last = value;
    }
}

void append_differences(std::vector<std::uint8_t>& bytes, std::span<const std::uint16_t> values) {
    for (const int shift : {0, 8}) {
        std::uint16_t last = 0;
        for (const auto value : values) {
            bytes.push_back(
                static_cast<std::uint8_t>(static_cast<std::uint16_t>(value - last) >> shift));
            last = value;
        }
    }
}

void append_numbers(std::vector<std::uint8_t>& bytes, std::span<const double> values) {
    for (const auto value : values)
        for (int shift = 0; shift < 64; shift += 8)
            bytes.push_back(
                static_cast<std::uint8_t>(std::bit_cast<std::uint64_t>(value) >> shift));
}

}  // namespace fluidcarve
