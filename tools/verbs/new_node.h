#pragma once

#include "graph/types/registry.h"

#include <map>
#include <string>
#include <string_view>

namespace fluidcarve {

/// Arguments of the verb `new-node`.
struct NewNode {
    std::string name;     ///< name of the node type: `acme.sparkle`
    bool solver = false;  ///< true: a solver; false: an energy
    /// True: an energy by a script of Python, for energy.python; false: a plugin.
    bool python = false;
    std::string folder;  ///< empty: `FAMILY_NAME` in the current folder
};

/// Writes a plugin with one node type, ready to build: source, test, build files, and a pipeline
/// that uses it; or a script, its test and its pipeline. Never overwrites files.
/// @return an exit code
int write_new_node(const NewNode& wanted, const Registry& registry);

/// Templates of these files, by name: tools/new_node/*.in. `{{family}}`, `{{name}}`, `{{Name}}`,
/// `{{type}}` and `{{folder}}` are placeholders.
const std::map<std::string_view, std::string_view>& new_node_texts();

}  // namespace fluidcarve
