#pragma once

#include "graph/types/registry.h"

#include <map>
#include <string>
#include <string_view>

namespace fluidcarve {

struct NewNode {
    std::string name;     ///< of the node type: `acme.sparkle`
    bool solver = false;  ///< in place of an energy
    std::string folder;   ///< empty: `acme_sparkle` in the current one
};

/// Writes a plugin with one node type that can be built as it is: source, test, build files, a pipeline that uses it. Overwrites nothing.
/// @return an exit code
int write_new_node(const NewNode& wanted, const Registry& registry);

/// What is written, by file: nodes/new_node/*.in, in which `{{family}}`, `{{name}}`, `{{Name}}`, `{{type}}` and `{{folder}}` stand for names.
const std::map<std::string_view, std::string_view>& new_node_texts();

}  // namespace fluidcarve
