#pragma once

#include "carve/volume/volume.h"

namespace fluidcarve {

/// What a grid shows: the inside of a level set, or where another grid exceeds a share of its
/// greatest value.
class ShownPart {
public:
    /// Of the greatest value.
    static constexpr float share = 0.02f;

    explicit ShownPart(const FloatGrid& grid);
    bool operator()(float value) const { return level_set_ ? value < edge_ : value > edge_; }

private:
    bool level_set_;
    float edge_;
};

}  // namespace fluidcarve
