#include "nodes/io/grid_names.h"

#include "graph/text/problem.h"
#include "nodes/io/picked_grid.h"

#include <fnmatch.h>

namespace fluidcarve {

std::set<const openvdb::GridBase*> grids_named(const Volume& volume, const std::vector<std::string>& names) {
    std::set<const openvdb::GridBase*> out;
    std::vector<std::string> known;
    for (const auto& grid : volume.grids) known.push_back(grid->getName());
    for (const auto& name : names) {
        bool any = false;
        for (const auto& grid : volume.grids)
            if (grid->getName() == name || fnmatch(name.c_str(), grid->getName().c_str(), FNM_NOESCAPE) == 0) {
                out.insert(grid.get());
                any = true;
            }
        if (!any) throw Failure("the volume " + lacks_grid(name, known));
    }
    return out;
}

}  // namespace fluidcarve
