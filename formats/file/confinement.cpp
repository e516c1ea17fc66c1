#include "formats/file/confinement.h"

#include "carve/base/failure.h"
#include "formats/file/full_path.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <optional>

namespace fluidcarve {
namespace {

/// The absolute place that a path leads to, without links; nothing if links form a cycle. Below a
/// missing folder there are no links.
std::optional<std::filesystem::path> place_behind_links(const std::filesystem::path& path) {
    std::error_code error;
    std::deque<std::filesystem::path> parts;
    const auto walk_first = [&](const std::filesystem::path& more) {
        parts.insert(parts.begin(), more.begin(), more.end());
    };
    walk_first(std::filesystem::absolute(path, error));
    std::filesystem::path out;
    for (int links = 0; !parts.empty();) {
        const auto part = std::move(parts.front());
        parts.pop_front();
        if (part.empty() || part == ".") continue;
        if (part == "..") {
            out = out.parent_path();
        } else if (!std::filesystem::is_symlink(out / part, error)) {
            out /= part;  // an absolute part replaces the whole path
        } else {
            const auto target = std::filesystem::read_symlink(out / part, error);
            if (error || ++links > most_symlinks) return std::nullopt;
            walk_first(target);
        }
    }
    return out;
}

}  // namespace

Confinement::Confinement(const std::vector<std::string>& folders) {
    for (const auto& each : folders) {
        std::error_code error;
        const auto folder = std::filesystem::canonical(each, error);
        if (error || !std::filesystem::is_directory(folder, error))
            throw Failure(fmt::format("--confine must be a folder that exists, not '{}'", each));
        folders_.push_back(folder);
    }
}

std::string Confinement::refusal(const std::string& path) const {
    if (!on()) return {};
    const auto place = place_behind_links(path);
    const auto holds = [&](const std::filesystem::path& folder) {
        return std::mismatch(folder.begin(), folder.end(), place->begin(), place->end()).first ==
               folder.end();
    };
    if (place && std::ranges::any_of(folders_, holds)) return {};
    std::string allowed;
    for (const auto& folder : folders_) allowed += (allowed.empty() ? "" : ", ") + folder.string();
    return fmt::format(
        "leads {}, outside of --confine ({}); move it there, or name its folder by another "
        "--confine",
        place ? "to " + place->string() : "from link to link without an end", allowed);
}

std::string Confinement::refusal_of_open(int descriptor) const {
    return refusal(fmt::format("/proc/self/fd/{}", descriptor));
}

Confinement& Confinement::program() {
    static Confinement all;
    return all;
}

}  // namespace fluidcarve
