#include "nodes/io/grid_names.h"

#include "graph/text/problem.h"
#include "nodes/io/picked_grid.h"

#include <fnmatch.h>

namespace fluidcarve {

std::set<const openvdb::GridBase*> grids_named(const Volume& volume, const std::vector<std::string>& names) {
    std::set<const openvdb::GridBase*> out;
    for (const auto& name : names) {
        bool any = false;
        for (const auto& grid : volume.grids)
            if (const auto own = grid.name(); own == name || fnmatch(name.c_str(), own.c_str(), FNM_NOESCAPE) == 0) {
                out.insert(&grid.header());
                any = true;
            }
        if (!any) throw Failure("the volume " + lacks_grid(name, volume.given_names()));
    }
    return out;
}

}  // namespace fluidcarve
