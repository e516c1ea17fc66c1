#include "carve/volume/volume.h"

#include "carve/base/numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace fluidcarve {

std::optional<std::size_t> find_name(const std::vector<std::string>& names,
                                     const std::string& wanted) {
    const auto place = [&](const auto& found) {
        return static_cast<std::size_t>(found - names.begin());
    };
    if (const auto found = std::ranges::find(names, wanted); found != names.end())
        return place(found);
    const auto open = wanted.rfind('[');
    if (open == std::string::npos || !wanted.ends_with(']')) return std::nullopt;
    auto number =
        number_of<std::size_t>(std::string_view(wanted).substr(open + 1, wanted.size() - open - 2));
    if (!number) return std::nullopt;
    for (auto found = names.begin(); found != names.end(); ++found)
        if (std::string_view(*found) == std::string_view(wanted).substr(0, open) &&
            (*number)-- == 0)
            return place(found);
    return std::nullopt;
}

openvdb::GridBase::ConstPtr Volume::find(const std::string& name) const {
    const auto found = place(name);
    return found ? grids[*found].grid() : nullptr;
}

std::optional<std::size_t> Volume::place(const std::string& name) const {
    return find_name(given_names(), name);
}

std::vector<std::string> Volume::given_names() const {
    std::vector<std::string> out;
    for (const auto& grid : grids) out.push_back(grid.name());
    return out;
}

std::vector<std::string> Volume::unique_names() const {
    std::vector<std::string> out;
    const auto all = given_names();
    for (std::size_t n = 0; n < all.size(); ++n) {
        const bool several = std::ranges::count(all, all[n]) > 1;
        out.push_back(
            several ? fmt::format("{}[{}]", all[n],
                                  std::count(all.begin(),
                                             all.begin() + static_cast<std::ptrdiff_t>(n), all[n]))
                    : all[n]);
    }
    return out;
}

std::string Volume::names() const {
    std::string out;
    for (const auto& grid : grids) out += (out.empty() ? "" : ", ") + grid.name();
    return out;
}

}  // namespace fluidcarve
