#include "runtime/html/written_files.h"

#include "carve/base/words.h"
#include "formats/file/input_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace fluidcarve {

namespace {

using Json = nlohmann::ordered_json;

namespace fs = std::filesystem;

constexpr std::uintmax_t most_picture_bytes = 24 << 20;

/// Reads the file into `png`, or sets `fault`.
void read(PagePicture& picture) {
    std::error_code error;
    const auto bytes = fs::file_size(picture.path, error);
    if (error) picture.fault = "is not there";
    else if (bytes > most_picture_bytes) picture.fault = "is too large for a page";
    if (!picture.fault.empty()) return;
    try {
        picture.png = InputFile(picture.path, {.what = "a picture"}).whole();
    } catch (const Unreadable& unreadable) {
        picture.fault = unreadable.fault;
        return;
    }
    if (!picture.png.starts_with("\x89PNG\r\n\x1a\n"))
        picture = {picture.node, picture.path, "", "is no PNG file", picture.earlier};
}

bool is_picture(const std::string& path) { return ending_of(path) == ".png"; }

/// The address of a file in a link of a page.
std::string address_from(const fs::path& page, const fs::path& file) {
    std::error_code error;
    const auto folder = fs::absolute(page).parent_path();
    std::string out;
    for (const char each : fs::proximate(fs::absolute(file), folder, error).string())
        if (std::string_view(" %#?\"<>").find(each) == std::string_view::npos) out += each;
        else out += fmt::format("%{:02X}", static_cast<unsigned char>(each));
    return out;
}

}  // namespace

WrittenFiles written_files(const Pipeline& pipeline, const std::vector<int>& delivered,
                           const Json& report, fs::file_time_type start, const fs::path& page) {
    WrittenFiles out;
    for (const auto& node : pipeline.nodes)
        for (const auto& [param, pattern] : node.written()) {
            const auto frames = delivered.empty() || !pattern.per_frame()
                                    ? std::vector<int>{pipeline.frames.frames().front()}
                                    : delivered;
            for (const auto frame : frames) {
                std::error_code error;
                if (const auto bytes = fs::file_size(pattern.at(frame), error); !error)
                    out.bytes[node.name] += bytes;
            }
            const auto path = pattern.at(frames.front());
            std::error_code error;
            if (ending_of(path) == ".html" && fs::exists(path, error))
                out.pages.push_back({node.name, path, address_from(page, path)});
            if (!is_picture(path)) continue;
            const auto& nodes = report.at("nodes");
            const bool current = nodes.contains(node.name) &&
                                 nodes.at(node.name).at("cached").get<std::size_t>() > 0;
            const auto written = fs::last_write_time(path, error);
            out.pictures.push_back(
                {node.name, path, "", "", !error && written < start && !current});
            read(out.pictures.back());
        }
    return out;
}

}  // namespace fluidcarve
