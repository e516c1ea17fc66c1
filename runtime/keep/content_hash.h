#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace fluidcarve {

/// 128 bits that stand for a content. All zero: of something that nobody knows.
struct Key {
    std::uint64_t high = 0, low = 0;

    explicit operator bool() const { return high != 0 || low != 0; }
    auto operator<=>(const Key&) const = default;
    /// 32 hex digits.
    std::string text() const;
    /// The reverse; what is no key gives one of nothing.
    static Key parse(std::string_view text);
};

/// Hashes what follows each other (XXH3, 128 bits): against accidents, not against attacks.
class ContentHash {
public:
    ContentHash();
    ~ContentHash();
    ContentHash(const ContentHash&) = delete;
    ContentHash& operator=(const ContentHash&) = delete;

    ContentHash& bytes(const void* data, std::size_t size);
    /// With its length, so that no two lists of texts look alike.
    ContentHash& text(std::string_view text);
    ContentHash& number(std::uint64_t number);
    /// A key of nothing makes the whole one.
    ContentHash& key(const Key& key);
    Key digest() const;

private:
    struct State;
    std::unique_ptr<State> state_;
    bool unknown_ = false;
};

}  // namespace fluidcarve
