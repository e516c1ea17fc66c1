#pragma once

#include "runtime/jobs/engine.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// All engines, in the order of the help.
const std::vector<FarmEngine>& farm_engines();

/// The engine of a name; null: there is none.
const FarmEngine* find_engine(const std::string& name);

}  // namespace fluidcarve
