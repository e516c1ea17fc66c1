#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fluidcarve {

/// What made a file, as the file states it: names and texts, in the order of `provenance_names`.
/// Each text is one line of ASCII.
using Provenance = std::vector<std::pair<std::string, std::string>>;

/// The names of all entries. pipelines/FORMATS.md says what they hold.
inline constexpr std::array<std::string_view, 5> provenance_names{
    "fluidcarve_version", "fluidcarve_pipeline", "fluidcarve_values", "fluidcarve_seams",
    "fluidcarve_command"};

inline bool is_provenance(std::string_view name) {
    return std::ranges::find(provenance_names, name) != provenance_names.end();
}

/// An entry in files that hold it as a comment: `fluidcarve_version: 0.1.0`.
inline std::string provenance_line(const Provenance::value_type& entry) {
    return entry.first + ": " + entry.second;
}

/// The entry that a comment holds; two empty texts if it holds none.
/// @param comment  a line without its comment sign
inline Provenance::value_type provenance_of_line(std::string_view comment) {
    const auto end = comment.find(": ");
    const auto name = comment.substr(0, end);
    if (end == std::string_view::npos || !is_provenance(name)) return {};
    return {std::string(name), std::string(comment.substr(end + 2))};
}

}  // namespace fluidcarve
