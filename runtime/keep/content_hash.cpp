#include "runtime/keep/content_hash.h"

#include <fmt/format.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <charconv>

namespace fluidcarve {

struct ContentHash::State {
    XXH3_state_t xxh;
};

std::string Key::text() const { return fmt::format("{:016x}{:016x}", high, low); }

std::string Key::path() const { return text().insert(2, "/"); }

Key Key::parse(std::string_view text) {
    Key out;
    if (text.size() != 32) return out;
    const auto half = [](std::string_view digits, std::uint64_t& into) {
        const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), into, 16);
        return end.ec == std::errc() && end.ptr == digits.data() + digits.size();
    };
    return half(text.substr(0, 16), out.high) && half(text.substr(16), out.low) ? out : Key{};
}

ContentHash::ContentHash() : state_(new State) { XXH3_128bits_reset(&state_->xxh); }
ContentHash::~ContentHash() = default;

ContentHash& ContentHash::bytes(const void* data, std::size_t size) {
    XXH3_128bits_update(&state_->xxh, data, size);
    return *this;
}

ContentHash& ContentHash::text(std::string_view text) {
    return number(text.size()).bytes(text.data(), text.size());
}

ContentHash& ContentHash::number(std::uint64_t number) { return bytes(&number, sizeof number); }

ContentHash& ContentHash::key(const Key& key) {
    unknown_ = unknown_ || !key;
    return number(key.high).number(key.low);
}

Key ContentHash::digest() const {
    if (unknown_) return {};
    const auto hash = XXH3_128bits_digest(&state_->xxh);
    return {hash.high64, hash.low64};
}

}  // namespace fluidcarve
