#pragma once

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>

/// A new folder of a test's own, removed with all in it. What a killed process left behind is never
/// met again.
class Scratch {
public:
    Scratch() {
        auto name =
            (std::filesystem::temp_directory_path() / ("fluidcarve-test-" + std::string(6, 'X')))
                .string();
        if (!mkdtemp(name.data()))
            throw std::filesystem::filesystem_error(
                "no scratch folder", name, std::error_code(errno, std::generic_category()));
        path_ = name;
    }
    ~Scratch() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;

    std::string operator/(const std::string& name) const { return (path_ / name).string(); }
    std::string path() const { return path_.string(); }

    /// Writes a file in the folder; returns its path.
    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(path_ / name, std::ios::binary) << text;
        return *this / name;
    }
    static std::string read(const std::string& path) {
        std::ifstream in(path, std::ios::binary);
        std::ostringstream out;
        out << in.rdbuf();
        return out.str();
    }

private:
    std::filesystem::path path_;
};
