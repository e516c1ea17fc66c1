#include "tools/reading/sequences.h"

#include "carve/base/failure.h"
#include "formats/file/frame_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

namespace fluidcarve {
namespace {

namespace fs = std::filesystem;

/// A path in three parts, the middle one the digits right before its ending; no digits: it has
/// none.
struct Numbered {
    std::string before, digits, ending;
};

Numbered numbered(const std::string& path) {
    const auto name = fs::path(path).filename().string();
    const auto ending = fs::path(name).extension().string();
    const auto stem = path.substr(0, path.size() - ending.size());
    auto begin = stem.size();
    while (begin > path.size() - name.size() && stem[begin - 1] >= '0' && stem[begin - 1] <= '9')
        --begin;
    return {stem.substr(0, begin), stem.substr(begin), ending};
}

/// The whole number at the start of a text; nothing if there is none, or it is too large.
std::optional<int> number_in(std::string_view text) {
    int out = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), out);
    return error == std::errc{} ? std::optional(out) : std::nullopt;
}

/// All paths as one sequence; nothing if they do not share a number of digits, or would not be
/// found again by a path with a token.
std::optional<FileSequence> as_one(const std::vector<std::string>& paths) {
    const auto parts = numbered(paths.front());
    auto digits = parts.digits.size();
    for (const auto& path : paths) digits = std::min(digits, numbered(path).digits.size());
    const PathPattern pattern(parts.before + std::string(digits, '#') + parts.ending);
    std::vector<int> frames;
    for (const auto& path : paths) {
        const auto frame = number_in(numbered(path).digits);
        if (!frame || pattern.at(*frame) != path) return std::nullopt;
        frames.push_back(*frame);
    }
    return FileSequence{pattern, FrameSet(std::move(frames))};
}

FileSequence alone(const std::string& path) { return {PathPattern::literal(path)}; }

}  // namespace

std::string FileSequence::text() const {
    return per_frame() ? fmt::format("{} {}", path.text(), frames.text()) : path.text();
}

std::vector<FileSequence> sequences_of(const std::vector<std::string>& paths) {
    using Key = std::pair<std::string, std::string>;
    std::vector<Key> order;
    std::map<Key, std::vector<std::string>> groups;
    for (const auto& path : paths) {
        const auto parts = numbered(path);
        const Key key{parts.before, parts.digits.empty() ? parts.ending : "#" + parts.ending};
        auto& files = groups[key];
        if (files.empty()) order.push_back(key);
        if (std::ranges::find(files, path) == files.end()) files.push_back(path);
    }
    std::vector<FileSequence> out;
    for (const auto& key : order) {
        const auto& files = groups[key];
        if (auto sequence = files.size() > 1 ? as_one(files) : std::nullopt)
            out.push_back(std::move(*sequence));
        else std::ranges::transform(files, std::back_inserter(out), alone);
    }
    return out;
}

std::vector<FileSequence> sequences_in(const std::string& folder,
                                       const std::function<bool(const std::string& path)>& wanted,
                                       std::size_t& others) {
    auto paths = files_in(folder);
    const auto all = paths.size();
    std::erase_if(paths, [&](const auto& path) { return !wanted(path); });
    others = all - paths.size();
    std::ranges::sort(paths);
    return sequences_of(paths);
}

FileSequence named_sequence(const std::string& argument) {
    std::error_code ignored;
    // A file may have any name.
    if (fs::exists(argument, ignored)) return alone(argument);
    const PathPattern pattern(argument);
    if (!pattern.bad_token().empty())
        throw Failure(fmt::format("{} has '{}', which is no frame token; write #### or %04d",
                                  argument, pattern.bad_token()));
    if (!pattern.per_frame()) return alone(argument);
    auto frames = frames_there(pattern);
    if (!frames)
        throw Failure(fmt::format(
            "{} has a frame token in its folder; name the files of one folder", argument));
    return {pattern, std::move(*frames)};
}

}  // namespace fluidcarve
