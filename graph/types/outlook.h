#pragma once

#include "carve/base/region.h"

#include <string>
#include <string_view>

namespace fluidcarve {

/// Interface for a node's `foresee`, which looks at what is known of its inputs before a run
/// starts.
class Outlook {
public:
    virtual ~Outlook() = default;
    /// Where an input lies; null: not known, or not connected.
    virtual const Region* region(std::string_view input) const = 0;
    virtual void lies(const Region& region) = 0;  ///< says where all outputs will lie; without a
                                                  ///< call it is not known
    virtual void warn(const std::string& message) = 0;
};

}  // namespace fluidcarve
