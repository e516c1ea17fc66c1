#pragma once

#include "graph/types/registry.h"

#include <string>

namespace fluidcarve {

/// What the declarations say, for people and for programs. Nothing here is written twice: it all comes from Declare.

/// All node types by family, a line each.
std::string listing(const Registry& registry);

/// One node type: ports, parameters and the shortest YAML that states all it needs.
std::string describe(const Registry& registry, const NodeType& type);

/// The whole reference, as Markdown.
std::string to_markdown(const Registry& registry);
std::string to_markdown(const Registry& registry, const NodeType& type);  ///< one node type's part

/// The whole reference, as JSON: `{nodes: [{name, doc, inputs, params, outputs}], types: [{name, doc}]}`.
/// A parameter has `value` (its form, in words), `unit`, `min`, `max`, `required` or `default` (as YAML).
std::string to_json(const Registry& registry);
std::string to_json(const Registry& registry, const NodeType& type);  ///< one entry of `nodes`

}  // namespace fluidcarve
