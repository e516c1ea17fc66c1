#include "graph/types/frame_files.h"

#include "graph/text/problem.h"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <string_view>
#include <system_error>

namespace fluidcarve {

namespace fs = std::filesystem;

std::vector<std::string> files_in(const std::string& folder) {
    std::error_code fault;
    std::vector<std::string> out;
    for (fs::directory_iterator at(folder.empty() ? "." : folder, fault), end; !fault && at != end; at.increment(fault)) {
        std::error_code ignored;
        if (at->is_regular_file(ignored)) out.push_back((fs::path(folder) / at->path().filename()).string());
    }
    if (fault) throw Failure(fmt::format("cannot read the folder {}: {}", folder, fault.message()), Failure::Kind::input);
    return out;
}

std::optional<FrameSet> frames_there(const PathPattern& path) {
    const auto ends = path.name_ends();
    if (!ends) return std::nullopt;
    const auto folder = fs::path(path.in_its_folder()).parent_path().string();
    std::error_code ignored;
    if (!fs::is_directory(folder.empty() ? "." : folder, ignored)) return FrameSet();
    std::vector<int> frames;
    for (const auto& file : files_in(folder)) {
        const auto name = fs::path(file).filename().string();
        if (!name.starts_with(ends->begin) || name.size() <= ends->begin.size()) continue;
        const auto digits = std::string_view(name).substr(ends->begin.size());
        int frame = 0;
        const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), frame);
        if (error == std::errc{} && fs::path(path.at(frame)).filename() == name) frames.push_back(frame);
    }
    return FrameSet(std::move(frames));
}

}  // namespace fluidcarve
