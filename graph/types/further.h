#pragma once

#include <string>
#include <vector>

namespace fluidcarve {

/// What results of a node depend on beside its inputs, its parameters and the files that these
/// name.
struct Further {
    std::vector<std::string> files;  ///< paths
    std::string version;             ///< of what is no file; empty: nothing
};

}  // namespace fluidcarve
