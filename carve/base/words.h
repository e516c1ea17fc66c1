#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace fluidcarve {

/// "12.3 ms", "4.56 s", "7.89 min", "1.23 h".
std::string duration_text(double seconds);
/// "512 B", "12.3 kB", "4.56 MB", "7.89 GB", in steps of 1000.
std::string size_text(std::uint64_t bytes);
/// A count with its noun: "1 seam", "6 seams".
std::string counted(std::size_t count, std::string_view what);
/// "a", "a or b", "a, b or c". @param all  one or more
std::string either(const std::vector<std::string>& all);
/// The numbers of a place, a voxel or a vertex: "1.5, 2, 3".
std::string numbers_text(const std::array<double, 3>& of);
std::string numbers_text(const std::array<int, 3>& of);
template <class Three>
std::string numbers_text(const Three& of) {
    using Number =
        std::conditional_t<std::is_integral_v<std::remove_cvref_t<decltype(of[0])>>, int, double>;
    return numbers_text(std::array<Number, 3>{of[0], of[1], of[2]});
}
/// A text in small letters; only A to Z change.
std::string in_small_letters(std::string_view text);
/// The ending of a file's name in small letters: ".obj"; empty: it has none.
std::string ending_of(std::string_view path);

/// The candidate nearest to `name` by edit distance; empty if none is near enough to be a typing
/// error.
std::string nearest(std::string_view name, const std::vector<std::string>& candidates);
/// "; did you mean 'x'?" for the nearest candidate, else "; known: a, b, c".
std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace fluidcarve
