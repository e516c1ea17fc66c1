#pragma once

#include <array>
#include <string>
#include <vector>

namespace fluidcarve {

/// Bounding boxes of content in world space over all frames, estimated before a run. An estimate
/// may be too large, not too small.
struct Region {
    struct Box {
        std::array<double, 3> low, high;  ///< corners, world units
    };
    /// The bounding boxes if one parameter had another value.
    struct Otherwise {
        std::string how;  ///< the parameter, for messages: "`axes: y_to_z` in rig.curve"
        std::vector<Box> boxes;
    };
    std::vector<Box> boxes;  ///< their union holds all content; none: no content
    std::vector<Otherwise> otherwise;
};

/// Whether a box of `a` intersects a box of `b`.
bool meet(const std::vector<Region::Box>& a, const std::vector<Region::Box>& b);
/// The bounding box of all boxes. @param boxes  at least one
Region::Box around(const std::vector<Region::Box>& boxes);
/// The region with its boxes grown on all sides. @param by  world units
Region widened(Region region, double by);
/// For messages: "(0, 0, 0) to (1, 2, 3)".
std::string to_text(const Region::Box& box);

}  // namespace fluidcarve
