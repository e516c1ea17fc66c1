#include "formats/seam_file/seam_checksum.h"

#include "formats/seam_file/seam_metadata.h"

#include <fmt/format.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstdint>
#include <string_view>

namespace fluidcarve {

namespace {

static_assert(std::endian::native == std::endian::little, "checksums are of little-endian numbers");

class SeamHash {
public:
    SeamHash() { XXH3_128bits_reset(&state_); }
    void bytes(const void* data, std::size_t size) { XXH3_128bits_update(&state_, data, size); }
    /// A text behind its length.
    void text(std::string_view text) {
        const std::uint64_t length = text.size();
        bytes(&length, sizeof length);
        bytes(text.data(), text.size());
    }
    void seam(const Seams::Seam& seam, Seams::Kind kind) {
        text(to_text(kind));
        bytes(&seam.energy, sizeof seam.energy);
        const auto entries = seam.at.all();
        bytes(entries.data(), entries.size_bytes());
    }
    void warp(const Warp& warp) {
        const auto scale = static_cast<float>(warp.scale());
        for (std::size_t t = 0; t < warp.frames(); ++t)
            for (const float value : warp.values(t)) {
                const float scaled = scale * value;
                bytes(&scaled, sizeof scaled);
            }
    }
    XXH128_hash_t digest() const { return XXH3_128bits_digest(&state_); }

private:
    XXH3_state_t state_;
};

}  // namespace

std::string seam_checksum(const Seams& seams) {
    SeamHash hash;
    for (const auto& [name, text] : seam_texts(seams)) {
        hash.text(name);
        hash.text(text);
    }
    for (std::size_t n = 0; n < seams.seams.size(); ++n) {
        hash.seam(seams.seams[n], seams.kind);
        if (seams.paired()) hash.seam(seams.pairs[n], opposite(seams.kind));
    }
    if (seams.warp) hash.warp(*seams.warp);
    const auto out = hash.digest();
    return fmt::format("xxh3-128:{:016x}{:016x}", out.high64, out.low64);
}

}  // namespace fluidcarve
