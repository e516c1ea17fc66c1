#include "formats/image/image_provenance.h"

#include <fmt/format.h>
#include <zlib.h>

#include <cstdint>
#include <fstream>
#include <string_view>

namespace fluidcarve {
namespace {

using namespace std::string_view_literals;

constexpr auto png_start = "\x89PNG\r\n\x1a\n"sv, jpeg_start = "\xff\xd8"sv,
               exr_start = "\x76\x2f\x31\x01"sv;
/// Bytes of the signature and the first chunk.
constexpr std::uint64_t png_header = 8 + 4 + 4 + 13 + 4;
constexpr auto app9 = "\xff\xe9"sv, segment_owner = "fluidcarve\0"sv;
constexpr std::uint64_t most_text = 1 << 20;  ///< bytes of an entry that is read

/// A number of two or four bytes, the highest first.
std::string big_bytes(std::uint32_t number, int bytes) {
    std::string out;
    for (int n = bytes - 1; n >= 0; --n) out += static_cast<char>(number >> (8 * n) & 0xff);
    return out;
}

std::uint32_t big_number(std::string_view bytes) {
    std::uint32_t out = 0;
    for (const unsigned char byte : bytes) out = out << 8 | byte;
    return out;
}

std::string png_chunk(const Provenance::value_type& entry) {
    const auto body = "tEXt" + entry.first + '\0' + entry.second;
    return big_bytes(static_cast<std::uint32_t>(body.size() - 4), 4) + body +
           big_bytes(static_cast<std::uint32_t>(
                         crc32_z(0, reinterpret_cast<const Bytef*>(body.data()), body.size())),
                     4);
}

std::string jpeg_segment(const Provenance::value_type& entry) {
    const auto body = std::string(segment_owner) + provenance_line(entry);
    return std::string(app9) + big_bytes(static_cast<std::uint32_t>(body.size() + 2), 2) + body;
}

/// Reads a file piece by piece. If a piece is missing, the file is damaged.
class Pieces {
public:
    explicit Pieces(const InputFile& file) : file_(file) {}

    bool begins_with(std::string_view start) const {
        return file_.size() >= start.size() && file_.head(start.size()) == start;
    }
    std::uint64_t at() const { return at_; }
    void skip(std::uint64_t bytes) {
        if (bytes > file_.size() - at_)
            throw Failure(fmt::format("{} is cut off or damaged at byte {}; copy or write it again",
                                      file_.path(), at_),
                          Failure::Kind::input);
        at_ += bytes;
    }
    std::string take(std::uint64_t bytes) {
        const auto from = at_;
        skip(bytes);
        std::string out(bytes, '\0');
        file_.read(from, out.data(), out.size());
        return out;
    }
    /// A text that ends with a 0.
    std::string take_name() {
        constexpr std::size_t most_name = 256;
        std::string out;
        for (auto c = take(1); c[0] != '\0'; c = take(1)) {
            out += c;
            if (out.size() > most_name) skip(file_.size());
        }
        return out;
    }

private:
    const InputFile& file_;
    std::uint64_t at_ = 0;
};

Provenance of_png(Pieces& file) {
    Provenance out;
    file.skip(png_start.size());
    while (true) {
        const auto head = file.take(8);
        const auto length = big_number(std::string_view(head).substr(0, 4));
        const auto type = head.substr(4);
        if (type == "IDAT" || type == "IEND") return out;
        if (type == "tEXt" && length <= most_text) {
            const auto body = file.take(length);
            const auto end = body.find('\0');
            if (end != std::string::npos && is_provenance(body.substr(0, end)))
                out.emplace_back(body.substr(0, end), body.substr(end + 1));
        } else {
            file.skip(length);
        }
        file.skip(4);
    }
}

/// Walks the first segments of a JPEG file, up to the first that is not an application's.
/// @return where that segment begins
std::uint64_t walk_jpeg(Pieces& file, Provenance& out) {
    file.skip(jpeg_start.size());
    while (true) {
        const auto begin = file.at();
        const auto head = file.take(4);
        const auto marker = static_cast<unsigned char>(head[1]);
        if (head[0] != '\xff' || marker < 0xe0 || marker > 0xef) return begin;
        const auto length = big_number(std::string_view(head).substr(2));
        if (length < 2) file.skip(~std::uint64_t{0});
        const auto body = file.take(length - 2);
        if (!head.starts_with(app9) || !body.starts_with(segment_owner)) continue;
        if (auto entry = provenance_of_line(std::string_view(body).substr(segment_owner.size()));
            !entry.first.empty())
            out.push_back(std::move(entry));
    }
}

Provenance of_exr(Pieces& file) {
    Provenance out;
    file.skip(exr_start.size() + 4);
    for (auto name = file.take_name(); !name.empty(); name = file.take_name()) {
        const auto type = file.take_name();
        const auto size = file.take(4);
        const auto bytes = big_number(std::string{size[3], size[2], size[1], size[0]});
        if (type == "string" && bytes <= most_text && is_provenance(name))
            out.emplace_back(name, file.take(bytes));
        else file.skip(bytes);
    }
    return out;
}

}  // namespace

void add_provenance(const std::string& path, const Provenance& provenance) {
    if (provenance.empty()) return;
    std::string texts, whole;
    std::uint64_t at = 0;
    {
        const InputFile file(path, {.what = "an image"});
        Pieces pieces(file);
        Provenance none;
        const bool png = pieces.begins_with(png_start);
        if (!png && !pieces.begins_with(jpeg_start)) return;
        for (const auto& entry : provenance) texts += png ? png_chunk(entry) : jpeg_segment(entry);
        at = png ? png_header : walk_jpeg(pieces, none);
        whole = file.whole();
    }
    std::ofstream out(path, std::ios::binary | std::ios::trunc);
    out << std::string_view(whole).substr(0, at) << texts << std::string_view(whole).substr(at);
    out.close();
    if (!out)
        throw Failure(fmt::format(
            "cannot write {}: the file did not come out whole; is the disk full?", path));
}

Provenance provenance_of_image(const InputFile& file) {
    Pieces pieces(file);
    Provenance out;
    if (pieces.begins_with(png_start)) return of_png(pieces);
    if (pieces.begins_with(exr_start)) return of_exr(pieces);
    if (pieces.begins_with(jpeg_start)) walk_jpeg(pieces, out);
    return out;
}

}  // namespace fluidcarve
