#pragma once

#include <array>
#include <string>
#include <vector>

namespace fluidcarve {

/// Where something lies in the world, over all frames, as far as it is known before a run: rather
/// too much space than too little.
struct Region {
    struct Box {
        std::array<double, 3> low, high;  ///< corners, world units
    };
    /// Where it would lie if a parameter were another.
    struct Otherwise {
        std::string how;  ///< the parameter, for messages: "`axes: y_to_z` in rig.curve"
        std::vector<Box> boxes;
    };
    std::vector<Box> boxes;  ///< together they hold all of it; none: it is empty
    std::vector<Otherwise> otherwise;
};

/// Whether any box of one list meets any of the other.
bool meet(const std::vector<Region::Box>& a, const std::vector<Region::Box>& b);
/// The box around all boxes. @param boxes  at least one
Region::Box around(const std::vector<Region::Box>& boxes);
/// A region whose boxes reach further on all sides. @param by  world units
Region widened(Region region, double by);
/// For messages: "(0, 0, 0) to (1, 2, 3)".
std::string text_of(const Region::Box& box);

}  // namespace fluidcarve
