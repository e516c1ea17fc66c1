#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace fluidcarve {

/// A 128-bit hash of a content. All zero: the content is unknown.
struct Key {
    std::uint64_t high = 0, low = 0;

    explicit operator bool() const { return high != 0 || low != 0; }
    auto operator<=>(const Key&) const = default;
    /// The key as 32 hex digits.
    std::string text() const;
    /// The path of a file named by the key, below the folder of its kind: two of the digits, `/`,
    /// the other 30.
    std::string path() const;
    /// Reads the result of `text`. Any other text gives the zero key.
    static Key parse(std::string_view text);
};

/// Hashes a sequence of values (XXH3, 128 bits). Not safe against deliberate collisions.
class ContentHash {
public:
    ContentHash();
    ~ContentHash();
    ContentHash(const ContentHash&) = delete;
    ContentHash& operator=(const ContentHash&) = delete;

    ContentHash& bytes(const void* data, std::size_t size);
    /// Includes the length, so that different lists of texts give different hashes.
    ContentHash& text(std::string_view text);
    ContentHash& number(std::uint64_t number);
    /// A zero key makes the digest zero.
    ContentHash& key(const Key& key);
    Key digest() const;

private:
    struct State;
    std::unique_ptr<State> state_;
    bool unknown_ = false;
};

}  // namespace fluidcarve
