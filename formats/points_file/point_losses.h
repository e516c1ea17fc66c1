#pragma once

#include <string>
#include <vector>

namespace fluidcarve {

/// What a written file of points does not hold.
struct PointLosses {
    /// Names of attributes that the format can't hold; they were not written.
    std::vector<std::string> attributes;
    std::string offset;  ///< the `offset` that points.read needs for this file; empty: none
    bool width = false;  ///< true: the width of the points
};

}  // namespace fluidcarve
