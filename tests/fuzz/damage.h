#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>

namespace fuzz {

using Random = std::mt19937_64;

/// A number from 0 to `end` - 1; 0 if `end` is 0.
inline std::size_t below(Random& random, std::size_t end) { return end == 0 ? 0 : random() % end; }

template <class List>
const auto& any_of(const List& list, Random& random) {
    return list[below(random, std::size(list))];
}

/// The number at a place of a file.
template <class T>
T number_at(const std::string& file, std::size_t at) {
    T out{};
    std::memcpy(&out, file.data() + at, sizeof out);
    return out;
}

template <class T>
void set_number(std::string& file, std::size_t at, T number) {
    std::memcpy(file.data() + at, &number, sizeof number);
}

/// Faults of a disk or a network: bits, bytes, numbers, pieces.
std::string damaged(std::string file, Random& random);

/// Slips of the hand in a pipeline, and malice.
std::string mistyped(std::string text, Random& random);

/// Numbers and words of a text file that become others: the numbers that readers trust are counts
/// and indices.
std::string retold(std::string text, Random& random);

}  // namespace fuzz
