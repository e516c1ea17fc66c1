#pragma once

#include "nodes/preview/canvas.h"

// Colours, types and margin of sheets.

namespace fluidcarve::sheet_style {

inline constexpr Colour paper{30, 31, 35};
inline constexpr Colour bright{238, 238, 238};
inline constexpr Colour dim{166, 170, 178};
inline constexpr Canvas::TextStyle title{20, true, bright};
inline constexpr Canvas::TextStyle heading{14, true, bright};
inline constexpr Canvas::TextStyle plain{12, false, dim};
inline constexpr double margin = 20;  ///< pixels

}  // namespace fluidcarve::sheet_style
