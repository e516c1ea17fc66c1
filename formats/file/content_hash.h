#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace fluidcarve {

/// A 128-bit hash of a content. All zero: the content is unknown.
struct Hash {
    std::uint64_t high = 0, low = 0;

    explicit operator bool() const { return high != 0 || low != 0; }
    auto operator<=>(const Hash&) const = default;
    /// The hash as 32 hex digits.
    std::string text() const;
    /// The path of a file named by the hash, below the folder of its kind: two of the digits, `/`,
    /// the other 30.
    std::string path() const;
    /// Reads the result of `text`. Any other text gives the zero hash.
    static Hash parse(std::string_view text);
};

/// Hashes a sequence of values (XXH3, 128 bits). Not safe against deliberate collisions.
class Hasher {
public:
    Hasher();
    ~Hasher();
    Hasher(const Hasher&) = delete;
    Hasher& operator=(const Hasher&) = delete;

    Hasher& bytes(const void* data, std::size_t size);
    /// Includes the length, so that different lists of texts give different hashes.
    Hasher& text(std::string_view text);
    Hasher& number(std::uint64_t number);
    /// A zero hash makes the digest zero.
    Hasher& hash(const Hash& hash);
    Hash digest() const;

private:
    struct State;
    std::unique_ptr<State> state_;
    bool unknown_ = false;
};

}  // namespace fluidcarve
