#include "formats/file/content_hash.h"

#include <fmt/format.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <charconv>

namespace fluidcarve {

struct Hasher::State {
    XXH3_state_t xxh;
};

std::string Hash::text() const { return fmt::format("{:016x}{:016x}", high, low); }

std::string Hash::path() const { return text().insert(2, "/"); }

Hash Hash::parse(std::string_view text) {
    Hash out;
    if (text.size() != 32) return out;
    const auto half = [](std::string_view digits, std::uint64_t& into) {
        const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), into, 16);
        return end.ec == std::errc() && end.ptr == digits.data() + digits.size();
    };
    return half(text.substr(0, 16), out.high) && half(text.substr(16), out.low) ? out : Hash{};
}

Hasher::Hasher() : state_(new State) { XXH3_128bits_reset(&state_->xxh); }
Hasher::~Hasher() = default;

Hasher& Hasher::bytes(const void* data, std::size_t size) {
    XXH3_128bits_update(&state_->xxh, data, size);
    return *this;
}

Hasher& Hasher::text(std::string_view text) {
    return number(text.size()).bytes(text.data(), text.size());
}

Hasher& Hasher::number(std::uint64_t number) { return bytes(&number, sizeof number); }

Hasher& Hasher::hash(const Hash& hash) {
    unknown_ = unknown_ || !hash;
    return number(hash.high).number(hash.low);
}

Hash Hasher::digest() const {
    if (unknown_) return {};
    const auto hash = XXH3_128bits_digest(&state_->xxh);
    return {hash.high64, hash.low64};
}

}  // namespace fluidcarve
