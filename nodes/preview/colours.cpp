#include "nodes/preview/colours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace fluidcarve {

namespace {

constexpr std::array<Colour, 11> heat_steps{{{0, 0, 4},
                                             {22, 11, 57},
                                             {66, 10, 104},
                                             {106, 23, 110},
                                             {147, 38, 103},
                                             {188, 55, 84},
                                             {221, 81, 58},
                                             {243, 120, 25},
                                             {252, 165, 10},
                                             {246, 215, 70},
                                             {252, 255, 164}}};

// Hues 250 and 45 degrees in Oklab, lightness 0.25 to 0.88 in even steps.
constexpr std::array<Colour, 11> diverging_steps{{{186, 219, 255},
                                                  {107, 180, 254},
                                                  {50, 140, 223},
                                                  {16, 102, 173},
                                                  {24, 67, 108},
                                                  {34, 34, 34},
                                                  {101, 48, 22},
                                                  {160, 69, 16},
                                                  {208, 102, 48},
                                                  {243, 147, 103},
                                                  {254, 202, 179}}};

// Colours of glowing iron.
constexpr std::array<Colour, 7> flame_steps{{{0, 0, 0},
                                             {92, 14, 2},
                                             {176, 38, 6},
                                             {232, 84, 14},
                                             {252, 146, 36},
                                             {255, 206, 96},
                                             {255, 246, 214}}};

template <std::size_t N>
Colour between(const std::array<Colour, N>& steps, double fraction) {
    const double place = std::clamp(fraction, 0.0, 1.0) * (N - 1);
    const auto step = std::min(static_cast<std::size_t>(place), N - 2);
    const double rest = place - static_cast<double>(step);
    const auto mix = [&](std::uint8_t a, std::uint8_t b) {
        return static_cast<std::uint8_t>(std::lround(a + (b - a) * rest));
    };
    const auto& low = steps[step];
    const auto& high = steps[step + 1];
    return {mix(low.red, high.red), mix(low.green, high.green), mix(low.blue, high.blue)};
}

}  // namespace

Colour heat(double fraction) { return between(heat_steps, std::isnan(fraction) ? 0 : fraction); }

Colour flame(double fraction) { return between(flame_steps, std::isnan(fraction) ? 0 : fraction); }

Colour diverging(double fraction) {
    return between(diverging_steps, std::isnan(fraction) ? 0.5 : (fraction + 1) / 2);
}

double on_screen(double light) { return 255 * std::pow(std::max(light, 0.0), 1 / 2.2); }

double of_screen(double value) { return std::pow(std::max(value, 0.0) / 255, 2.2); }

std::uint8_t screen_byte(double value) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

}  // namespace fluidcarve
