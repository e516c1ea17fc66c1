#include "nodes/image/image.h"

#include "graph/text/problem.h"
#include "graph/text/words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>

namespace fluidcarve {

namespace {

[[noreturn]] void refuse(const std::string& message) { throw Failure(message, Failure::Kind::input); }

const std::vector<ImageFormat>& formats() {
    using namespace std::string_literals;
    static const std::vector<ImageFormat> all{
        {"png", "PNG", {".png"}, {"\x89PNG\r\n\x1a\n"}, {"uint8", "uint16"}},
        {"openexr", "EXR", {".exr"}, {"\x76\x2f\x31\x01"}, {"half", "float"}},
        {"jpeg", "JPEG", {".jpg", ".jpeg"}, {"\xff\xd8\xff"}, {"uint8"}},
        {"tiff", "TIFF", {".tif", ".tiff"}, {"II*\0"s, "MM\0*"s, "II+\0"s, "MM\0+"s}, {"uint8", "int8", "uint16", "int16", "float", "double"}},
    };
    return all;
}

std::string shown_formats() {
    std::string out;
    for (const auto& format : formats()) out += (out.empty() ? "" : ", ") + format.shown;
    return out;
}

}  // namespace

const ImageFormat* format_of_name(const std::string& path) {
    const auto ending = ending_of(path);
    for (const auto& format : formats())
        if (std::find(format.endings.begin(), format.endings.end(), ending) != format.endings.end()) return &format;
    return nullptr;
}

const ImageFormat& format_of_file(const std::string& path) {
    const auto begin = InputFile(path, image_use).head(8);
    for (const auto& format : formats())
        for (const auto& start : format.starts) {
            if (!begin.starts_with(start)) continue;
            const auto* const named = format_of_name(path);
            if (named && named != &format)
                refuse(fmt::format("{} holds {}, but its name says {}; rename it to end in {}", path, format.shown, named->shown, format.endings.front()));
            return format;
        }
    refuse(begin.empty() ? fmt::format("{} is empty", path) : fmt::format("{} is not an image in a supported format: {}", path, shown_formats()));
}

std::vector<std::string> all_image_endings() {
    std::vector<std::string> out;
    for (const auto& format : formats()) out.insert(out.end(), format.endings.begin(), format.endings.end());
    return out;
}

std::string image_endings() { return fmt::format("{}", fmt::join(all_image_endings(), ", ")); }

std::string no_channel(const std::string& channel, const std::string& there) { return fmt::format("there is no channel '{}'; there are {}", channel, there); }

void require_channels(const std::optional<std::vector<std::string>>& wanted, const std::vector<std::string>& there) {
    if (!wanted) return;
    for (const auto& channel : *wanted)
        if (std::find(there.begin(), there.end(), channel) == there.end()) throw Failure(no_channel(channel, fmt::format("{}", fmt::join(there, ", "))));
}

bool is_opacity(const std::string& channel) {
    const auto name = channel.substr(channel.rfind('.') + 1);
    return name == "A" || name == "alpha" || name == "Alpha";
}

bool depth_holds(const std::string& to, const std::string& from) {
    static const std::vector<std::pair<std::string, std::vector<std::string>>> holds{
        {"uint8", {"uint8"}},
        {"int8", {"int8"}},
        {"uint16", {"uint8", "uint16"}},
        {"int16", {"int16"}},
        {"half", {"uint8", "int8", "half"}},
        {"float", {"uint8", "int8", "uint16", "int16", "half", "float"}},
        {"double", {"uint8", "int8", "uint16", "int16", "half", "float", "uint32", "int32", "double"}},
    };
    const auto found = std::find_if(holds.begin(), holds.end(), [&](const auto& each) { return each.first == to; });
    return found != holds.end() && std::find(found->second.begin(), found->second.end(), from) != found->second.end();
}

}  // namespace fluidcarve
