#pragma once

#include <array>
#include <string>

namespace fluidcarve {

/// The interval that a lattice covers beside its rig: in world units, or in percent of the
/// content's width, so that one setting serves content of any size.
struct RigExtent {
    double low = 0, high = 0;
    bool percent = false;

    /// Both ends in world units. @param width  of the content, world units
    std::array<double, 2> of(double width) const {
        const double unit = percent ? width / 100 : 1;
        return {low * unit, high * unit};
    }
};

/// The extent as a pipeline states it.
std::string to_text(const RigExtent& extent);

}  // namespace fluidcarve
