#pragma once

#include "graph/document.h"
#include "graph/types/registry.h"

#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// A value and where it comes from.
struct ValueOrigin {
    std::string value;              ///< as YAML, on one line
    std::string from;               ///< "shots/sh010.yaml:4", "--set", "environment variable SHOT", "default"
    std::vector<std::string> with;  ///< names whose values stand inside the text or list
};

/// Where everything in a pipeline comes from.
struct Origins {
    using Fields = std::vector<std::pair<std::string, ValueOrigin>>;
    ValueOrigin frames;
    Fields params;
    /// In the order of the file. Of each node its type, inputs that are connected, all parameters, and what else is stated.
    std::vector<std::pair<std::string, Fields>> nodes;
};

/// @param document  one without problems
Origins origins_of(const Document& document, const Registry& registry);

/// A line each: `count = -18, from shots/sh010.yaml:4`.
std::string to_text(const Origins& origins);

/// `{frames: {value, from, with?}, params: {NAME: {value, from, with?}}, nodes: {NODE: {FIELD: {value, from, with?}}}}`,
/// each value as YAML.
std::string to_json(const Origins& origins);

}  // namespace fluidcarve
