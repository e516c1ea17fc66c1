#include "formats/seam_file/seam_checksum.h"

#include "formats/file/content_hash.h"
#include "formats/seam_file/seam_metadata.h"

#include <bit>

namespace fluidcarve {

namespace {

static_assert(std::endian::native == std::endian::little, "checksums are of little-endian numbers");

void add(Hasher& hash, const Seams::Seam& seam, Seams::Kind kind) {
    hash.text(to_text(kind)).bytes(&seam.energy, sizeof seam.energy);
    const auto entries = seam.at.all();
    hash.bytes(entries.data(), entries.size_bytes());
}

void add(Hasher& hash, const Warp& warp) {
    const auto scale = static_cast<float>(warp.scale());
    for (std::size_t t = 0; t < warp.frames(); ++t)
        for (const float value : warp.values(t)) {
            const float scaled = scale * value;
            hash.bytes(&scaled, sizeof scaled);
        }
}

}  // namespace

std::string seam_checksum(const Seams& seams) {
    Hasher hash;
    for (const auto& [name, text] : seam_texts(seams)) hash.text(name).text(text);
    for (std::size_t n = 0; n < seams.seams.size(); ++n) {
        add(hash, seams.seams[n], seams.kind);
        if (seams.paired()) add(hash, seams.pairs[n], opposite(seams.kind));
    }
    if (seams.warp) add(hash, *seams.warp);
    return "xxh3-128:" + hash.digest().text();
}

}  // namespace fluidcarve
