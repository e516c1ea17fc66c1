#pragma once

#include <string>
#include <vector>

namespace fluidcarve {

/// Further dependencies of a node's results, besides inputs, parameters and the files that these
/// name.
struct FurtherDependencies {
    std::vector<std::string> files;  ///< paths
    std::string version;             ///< version of dependencies that are not files; empty: none
};

}  // namespace fluidcarve
