#include "carve/grid/named_grids.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>

namespace fluidcarve {

std::string lacks_grid(const std::string& name, const std::vector<std::string>& known,
                       const std::string& because) {
    const auto best = nearest(name, known);
    return fmt::format("has no grid '{}'{}; it has {}{}", name, because,
                       known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", ")),
                       best.empty() ? "" : fmt::format("; did you mean '{}'?", best));
}

std::set<const openvdb::GridBase*> grids_named(const Volume& volume,
                                               const std::vector<std::string>& names) {
    std::set<const openvdb::GridBase*> out;
    for (const auto& name : names) {
        bool any = false;
        for (const auto& grid : volume.grids)
            if (const auto own = grid.name();
                own == name || fnmatch(name.c_str(), own.c_str(), FNM_NOESCAPE) == 0) {
                out.insert(&grid.header());
                any = true;
            }
        if (!any) throw Failure("the volume " + lacks_grid(name, volume.given_names()));
    }
    return out;
}

Volume picked(const Volume& volume, const std::vector<std::string>& names, bool keep) {
    const auto named = grids_named(volume, names);
    auto out = volume;
    std::erase_if(out.grids,
                  [&](const VolumeGrid& grid) { return named.contains(&grid.header()) != keep; });
    return out;
}

}  // namespace fluidcarve
