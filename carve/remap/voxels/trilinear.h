#pragma once

#include <array>
#include <cstddef>

namespace fluidcarve {

/// The value in a cell, mixed along one axis after the other. Equal values stay equal to the last
/// bit.
/// @param value    of a vertex of the cell, by its place from the lowest vertex on
/// @param strides  places from one vertex to the next, along the axis mixed first, second and third
/// @param parts    position in the cell along the same axes, 0 to 1
template <class Value, class Part>
auto trilinear(const Value& value, const std::array<std::size_t, 3>& strides,
               const std::array<Part, 3>& parts) {
    using Result = decltype(value(std::size_t{}));
    const auto mix = [](const Result& a, const Result& b, Part part) {
        return Result(a + (b - a) * part);
    };
    const auto line = [&](std::size_t n) { return mix(value(n), value(n + strides[0]), parts[0]); };
    const auto face = [&](std::size_t n) { return mix(line(n), line(n + strides[1]), parts[1]); };
    return mix(face(0), face(strides[2]), parts[2]);
}

}  // namespace fluidcarve
