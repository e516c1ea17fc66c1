#pragma once

#include "graph/types/registry.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace fluidcarve {

// The reference of node types, for people and for programs. All of it is derived from the
// declarations (Declare).

/// All node types by family, one line each.
/// @param only  a family; empty: all
std::string listing(const Registry& registry, const std::string& only = {});

/// One node type: ports, parameters and the shortest valid YAML.
std::string describe(const Registry& registry, const NodeType& type);

/// The whole reference as Markdown.
std::string to_markdown(const Registry& registry);
std::string to_markdown(const Registry& registry,
                        const NodeType& type);  ///< the part about one node type

std::string family_to_markdown(const Registry& registry,
                               const std::string& family);  ///< the part about a family

/// The whole reference as JSON:
/// `{nodes: [{name, doc, inputs, params, outputs, outputs_from?, version, kept}], types: [{name,
/// doc}]}`.
/// A parameter has `name`, `value` (its form in words), `choices?`, `unit?`, `min?`, `max?`,
/// `required` or `default` (as YAML), `doc`.
nlohmann::ordered_json to_json(const Registry& registry);
/// One entry of `nodes`.
nlohmann::ordered_json to_json(const Registry& registry, const NodeType& type);
/// `{nodes}` of a family.
nlohmann::ordered_json family_to_json(const Registry& registry, const std::string& family);

}  // namespace fluidcarve
