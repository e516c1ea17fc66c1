#pragma once

#include <filesystem>
#include <string>

/// Bytes of all files in a folder and below it; 0 if there is none.
inline double bytes_in(const std::string& folder) {
    double out = 0;
    std::error_code missing;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, missing))
        if (entry.is_regular_file()) out += static_cast<double>(entry.file_size());
    return out;
}
