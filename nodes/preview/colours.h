#pragma once

#include <cstdint>

namespace fluidcarve {

struct Colour {
    std::uint8_t red = 0;
    std::uint8_t green = 0;
    std::uint8_t blue = 0;
    bool operator==(const Colour&) const = default;
};

/// A dark to bright colour for 0 to 1: black, violet, red, orange, pale yellow, lightness rising evenly, so that equal
/// steps look equal, in grey too. Values outside are clamped.
Colour heat(double fraction);

/// The glow of fire for 0 to 1: black, dark red, orange, yellow, nearly white. Values outside are clamped.
Colour flame(double fraction);

/// A colour for -1 to 1: pale blue, blue, dark grey at 0, brown, pale orange. Lightness rises evenly from 0 to both
/// sides, and opposite values are equally light. Values outside are clamped.
Colour diverging(double fraction);

}  // namespace fluidcarve
