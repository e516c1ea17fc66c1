#pragma once

#include <cstdint>

namespace fluidcarve {

/// An sRGB colour.
struct Colour {
    std::uint8_t red = 0;
    std::uint8_t green = 0;
    std::uint8_t blue = 0;
    bool operator==(const Colour&) const = default;
};

/// Colour map for 0 to 1, clamped: black, violet, red, orange, pale yellow. Lightness rises evenly,
/// so that equal steps look equal, also in greyscale.
Colour heat(double fraction);

/// Colour map of glowing fire for 0 to 1, clamped: black, dark red, orange, yellow, nearly white.
Colour flame(double fraction);

/// Colour map for -1 to 1, clamped: pale blue, blue, dark grey at 0, brown, pale orange. Lightness
/// rises evenly from 0 to both sides; opposite values are equally light.
Colour diverging(double fraction);

/// Convert linear light to a screen value, 0 to 255 (gamma 2.2), and back.
double on_screen(double light);
double of_screen(double value);
/// A screen value, rounded and clamped.
std::uint8_t screen_byte(double value);

}  // namespace fluidcarve
