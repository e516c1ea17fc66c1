#pragma once

#include "carve/mesh/mesh.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

namespace fluidcarve::test {

/// A cube of six quads, from the origin on.
inline Mesh cube(double size) {
    Mesh out;
    for (int n = 0; n < 8; ++n)
        out.points.emplace_back(n & 1 ? size : 0, n & 2 ? size : 0, n & 4 ? size : 0);
    const std::array<std::array<std::uint32_t, 4>, 6> quads{
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
    for (const auto& quad : quads) out.add_face(quad);
    return out;
}

/// A value as a file holds it. @param big  the highest byte first
template <class T>
std::string bytes(T value, bool big = false) {
    std::string out(reinterpret_cast<const char*>(&value), sizeof(T));
    if (big) std::ranges::reverse(out);
    return out;
}

/// A PLY file of a triangle with normals, colours, numbers and a material, as text or in bytes.
/// @param big  as above
inline std::string ply_of(const std::string& format, bool big) {
    std::string out = "ply\nformat " + format +
                      " 1.0\ncomment a liquid\nelement vertex 3\nproperty float x\nproperty float "
                      "y\nproperty float z\nproperty float nx\nproperty float ny\n"
                      "property float nz\nproperty uchar red\nproperty uchar green\nproperty uchar "
                      "blue\nproperty uchar alpha\nproperty double age\n"
                      "property float s\nproperty float t\nelement face 1\nproperty list uchar int "
                      "vertex_indices\nproperty short material\nend_header\n";
    const bool text = format == "ascii";
    for (int n = 0; n < 3; ++n) {
        const std::array<float, 3> at{0.5f * static_cast<float>(n), n == 1 ? 1.0f : 0.0f, -2};
        const double age = 0.1 * n;
        if (text) {
            out += std::to_string(n) + (n == 1 ? "e-1 1 -2" : "e-1 0 -2") + " 0 0 1 255 " +
                   std::to_string(n) + " 7 128 " + (n == 1 ? "0.1" : "3") + " 0.25 1\n";
            continue;
        }
        for (const float c : at) out += bytes(c, big);
        for (const float c : {0.0f, 0.0f, 1.0f}) out += bytes(c, big);
        for (const int c : {255, n, 7, 128}) out += static_cast<char>(c);
        out += bytes(age, big) + bytes(0.25f, big) + bytes(1.0f, big);
    }
    if (text) return out + "3 0 1 2 -5\n";
    out += '\3';
    for (const std::int32_t n : {0, 1, 2}) out += bytes(n, big);
    return out + bytes(static_cast<std::int16_t>(-5), big);
}

}  // namespace fluidcarve::test
