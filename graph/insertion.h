#pragma once

#include "graph/text/value.h"

#include <string>

namespace fluidcarve {

/// One `${name}` that was replaced. If it was a whole value, the new value has the mark of the
/// param or variable.
struct Insertion {
    Mark in;  ///< the text that contains `${name}`; if it was a whole value, the list or map around
              ///< it
    std::string name;
};

}  // namespace fluidcarve
