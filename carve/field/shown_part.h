#pragma once

#include "carve/volume/volume.h"

namespace fluidcarve {

/// The visible part of a grid: the inside of a level set; in any other grid, values above a share
/// of the largest one.
class ShownPart {
public:
    /// Share of the largest value.
    static constexpr float share = 0.02f;

    explicit ShownPart(const FloatGrid& grid);
    bool operator()(float value) const { return level_set_ ? value < edge_ : value > edge_; }

private:
    bool level_set_;
    float edge_;
};

}  // namespace fluidcarve
