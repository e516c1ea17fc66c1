#pragma once

#include <filesystem>

namespace fluidcarve {

/// So many symbolic links are followed on the way to a file, as in Linux; more are a circle.
inline constexpr int most_symlinks = 40;

/// A path from the root, without `.` and `..`; symbolic links stay. If there is no working folder
/// any more, a relative path stays relative.
inline std::filesystem::path full_path(const std::filesystem::path& path) {
    std::error_code error;
    const auto full = std::filesystem::absolute(path, error);
    return (error ? path : full).lexically_normal();
}

/// A path from the root, without `.`, `..` and, as far as it exists, symbolic links. Empty if it is
/// unknown: what a descriptor leads to may have no path.
inline std::filesystem::path canonical_path(const std::filesystem::path& path) {
    std::error_code error;
    const auto full = std::filesystem::absolute(path, error);
    return error ? std::filesystem::path() : std::filesystem::weakly_canonical(full, error);
}

}  // namespace fluidcarve
