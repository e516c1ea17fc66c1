#include "tests/bench/large/curl_noise.h"

#include <array>
#include <cmath>
#include <random>

using openvdb::Vec3f;

CurlNoise::CurlNoise(unsigned seed) : swirls_(static_cast<std::size_t>(size) * size * size) {
    std::mt19937 random(seed);
    std::vector<Vec3f> potential(swirls_.size()), passed(swirls_.size());
    for (auto& at : potential)
        for (int axis = 0; axis < 3; ++axis) at[axis] = static_cast<float>(random()) * 0x1p-31f - 1;
    const auto fill = [](std::vector<Vec3f>& out, const auto& value) {
        for (int x = 0; x < size; ++x)
            for (int y = 0; y < size; ++y)
                for (int z = 0; z < size; ++z) out[place(x, y, z)] = value(x, y, z);
    };
    constexpr int passes = 2;
    for (int pass = 0; pass < passes; ++pass)
        for (const auto& [dx, dy, dz] :
             {std::array{1, 0, 0}, std::array{0, 1, 0}, std::array{0, 0, 1}}) {
            fill(passed, [&](int x, int y, int z) {
                return 0.25f *
                       (potential[place(x - dx, y - dy, z - dz)] + 2 * potential[place(x, y, z)] +
                        potential[place(x + dx, y + dy, z + dz)]);
            });
            potential.swap(passed);
        }
    fill(swirls_, [&](int x, int y, int z) {
        const auto along_x = potential[place(x + 1, y, z)] - potential[place(x - 1, y, z)];
        const auto along_y = potential[place(x, y + 1, z)] - potential[place(x, y - 1, z)];
        const auto along_z = potential[place(x, y, z + 1)] - potential[place(x, y, z - 1)];
        return Vec3f(along_y.z() - along_z.y(), along_z.x() - along_x.z(),
                     along_x.y() - along_y.x());
    });
    double squares = 0;
    for (const auto& swirl : swirls_) squares += swirl.lengthSqr() / 3;
    const auto scale =
        static_cast<float>(1 / std::sqrt(squares / static_cast<double>(swirls_.size())));
    for (auto& swirl : swirls_) swirl *= scale;
}

Vec3f CurlNoise::operator()(const Vec3f& at) const {
    std::array<int, 3> cell;
    Vec3f part;
    for (int axis = 0; axis < 3; ++axis) {
        const float cells = at[axis] * cells_per_wavelength, below = std::floor(cells);
        cell[static_cast<std::size_t>(axis)] = static_cast<int>(below);
        part[axis] = cells - below;
    }
    const auto [x, y, z] = cell;
    const auto between = [](const Vec3f& a, const Vec3f& b, float share) {
        return a + share * (b - a);
    };
    const auto row = [&](int i, int j) {
        return between(swirls_[place(i, j, z)], swirls_[place(i, j, z + 1)], part.z());
    };
    const auto plane = [&](int i) { return between(row(i, y), row(i, y + 1), part.y()); };
    return between(plane(x), plane(x + 1), part.x());
}
