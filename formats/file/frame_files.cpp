#include "formats/file/frame_files.h"

#include "carve/base/failure.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <string_view>
#include <system_error>

namespace fluidcarve {

namespace fs = std::filesystem;

std::vector<std::string> files_in(const std::string& folder) {
    std::error_code fault;
    std::vector<std::string> out;
    for (fs::directory_iterator at(folder.empty() ? "." : folder, fault), end; !fault && at != end;
         at.increment(fault)) {
        std::error_code ignored;
        if (at->is_regular_file(ignored))
            out.push_back((fs::path(folder) / at->path().filename()).string());
    }
    if (fault)
        throw Failure(fmt::format("cannot read the folder {}: {}", folder, fault.message()),
                      Failure::Kind::input);
    return out;
}

namespace {

/// Calls `visit(name, rest, frame)` for the files of a path's folder whose names begin as its own
/// do: the text behind that beginning, and the frame whose file it is, or nothing.
/// @return false if a token is in the path's folder
template <class Visit>
bool visit_files(const PathPattern& path, const Visit& visit) {
    const auto ends = path.name_ends();
    if (!ends) return false;
    const auto folder = fs::path(path.in_its_folder()).parent_path().string();
    std::error_code ignored;
    if (!fs::is_directory(folder.empty() ? "." : folder, ignored)) return true;
    for (const auto& file : files_in(folder)) {
        const auto name = fs::path(file).filename().string();
        if (!name.starts_with(ends->begin) || name.size() <= ends->begin.size()) continue;
        const auto rest = std::string_view(name).substr(ends->begin.size());
        int frame = 0;
        const auto [stop, error] = std::from_chars(rest.data(), rest.data() + rest.size(), frame);
        const bool whole = error == std::errc{} && fs::path(path.at(frame)).filename() == name;
        visit(name, rest, whole ? std::optional(frame) : std::nullopt);
    }
    return true;
}

}  // namespace

std::optional<FrameSet> frames_there(const PathPattern& path) {
    std::vector<int> frames;
    const auto add = [&](const std::string&, std::string_view, std::optional<int> frame) {
        if (frame) frames.push_back(*frame);
    };
    return visit_files(path, add) ? std::optional(FrameSet(std::move(frames))) : std::nullopt;
}

std::vector<std::string> odd_frames_there(const PathPattern& path) {
    constexpr std::size_t most = 3;
    const auto ends = path.name_ends();
    std::vector<std::string> out;
    visit_files(path,
                [&](const std::string& name, std::string_view rest, std::optional<int> frame) {
                    if (frame || !rest.ends_with(ends->end) || rest.size() <= ends->end.size())
                        return;
                    rest.remove_suffix(ends->end.size());
                    const bool digit = rest.find_first_of("0123456789") != std::string_view::npos;
                    if (digit && rest.find_first_not_of("0123456789.+-") == std::string_view::npos)
                        out.push_back(name);
                });
    std::ranges::sort(out);
    out.resize(std::min(out.size(), most));
    return out;
}

}  // namespace fluidcarve
