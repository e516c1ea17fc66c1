#pragma once

#include "graph/types/registry.h"

#include <string>

namespace fluidcarve {

/// JSON schema (draft 7) of pipeline files, with the declarations' docs as descriptions for editors.
/// It accepts every pipeline of these types that `check` accepts; it knows no names of nodes and ports, so `check` finds more.
/// In a file with `extends`, nodes may lack what the extended file states, and a null takes a field away.
std::string schema(const Registry& registry);

}  // namespace fluidcarve
