#pragma once

#include "graph/types/context.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// Dependencies of a node's results besides inputs, parameters and the files that these name.
struct FurtherDependencies {
    std::vector<std::string> files;  ///< paths
    std::string version;             ///< version of dependencies that are not files; empty: none
};

/// What a node with its parameters does, before it runs. Functions may refer to the parameters,
/// which live as long as the node.
struct NodeTraits {
    /// Of a node with `add` and `finish`: whether these are called.
    bool gathers = true;
    /// Whether results change from frame to frame though no input or file does. If a node gathers,
    /// false: all frames share one result. Nothing: as inputs and files do.
    std::optional<bool> animates{};
    /// Whether a node that gathers takes the frame of the context; empty: it takes all.
    std::function<bool(const Context&)> takes{};
    /// The frames in which a node that gathers delivers, given those that it takes; empty: the
    /// same.
    std::function<std::vector<int>(const std::vector<int>& frames)> retimes{};
    /// Empty: the results depend on nothing else.
    std::function<FurtherDependencies()> depends{};
};

}  // namespace fluidcarve
