#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// What one --over varies: a param, a node's field or the frames, and the values that it takes.
struct Varied {
    std::string target;
    std::vector<std::string> values;
};

/// The most combinations that one wedge may have.
inline constexpr std::size_t most_combinations = 64;

/// Reads `TARGET=VALUE,VALUE`. Commas in brackets, braces and quotes do not separate.
/// @throws Failure if a text has no target or no value, a value or a target is there twice, or
///   there are too many combinations
std::vector<Varied> read_varied(const std::vector<std::string>& texts);

/// One of the combinations: each target with its value.
using Combination = std::vector<std::pair<std::string, std::string>>;

/// All combinations; the last target varies fastest.
std::vector<Combination> combinations_of(const std::vector<Varied>& varied);

/// A folder's name for a combination: "03_count=-4_type=seam.greedy". Its letters mean nothing in
/// paths.
/// @param number  from 1
std::string folder_name(const Combination& combination, std::size_t number);

}  // namespace fluidcarve
