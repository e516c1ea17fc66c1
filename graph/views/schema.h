#pragma once

#include "graph/types/registry.h"

#include <string>

namespace fluidcarve {

/// JSON schema (draft 7) of pipeline files, for editors. Doc strings of the declarations become
/// descriptions.
/// It accepts every pipeline that `check` accepts. `check` finds more faults, since the schema does
/// not know the pipeline's nodes. In a file with `extends`, nodes may omit fields that the extended
/// file states, and a null removes a field.
std::string schema(const Registry& registry);

}  // namespace fluidcarve
