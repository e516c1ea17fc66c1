#pragma once

#include <filesystem>

namespace fluidcarve {

/// A path from the root, without `.` and `..`; symbolic links stay. If there is no working folder
/// any more, a relative path stays relative.
inline std::filesystem::path full_path(const std::filesystem::path& path) {
    std::error_code error;
    const auto full = std::filesystem::absolute(path, error);
    return (error ? path : full).lexically_normal();
}

}  // namespace fluidcarve
