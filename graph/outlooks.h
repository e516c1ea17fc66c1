#pragma once

#include "graph/pipeline.h"
#include "graph/types/outlook.h"

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace fluidcarve {

/// What nodes say of a run before it starts.
struct Outlooks {
    struct Remark {
        std::size_t node = 0;  ///< index in Pipeline::nodes
        std::string message;
    };
    std::vector<Remark> warnings;
    std::vector<Remark> faults;  ///< why nodes cannot run
};

/// Where outputs of readers lie, by node and name.
using ReadRegions = std::map<std::size_t, std::map<std::string, Region>>;

/// Calls the `foresee` of each node, and passes what nodes and readers say down the pipeline.
/// Opens no files.
/// @param needed  per node: whether the run needs it
/// @param read    empty: no file is known yet
Outlooks foresee(const Pipeline& pipeline, const std::vector<bool>& needed,
                 const ReadRegions& read);

}  // namespace fluidcarve
