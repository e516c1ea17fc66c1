#include "carve/seam/similarity.h"

#include <algorithm>
#include <limits>

namespace fluidcarve {

namespace {

constexpr int patch_reach = 4;         ///< of a patch around its middle, vertices
constexpr float least_content = 0.3f;  ///< share of a patch that must not be empty
constexpr int beyond_moved = 4;        ///< further vertices within which the nearest patch is
                                       ///< sought

/// Mean of each patch's values; at the rims, of the existing ones.
/// @param along  scratch for as many values
void patch_means(PlaneSamples& values, PlaneSamples& along) {
    const auto mean_of = [](int count, const auto& at, const auto& to) {
        double sum = 0;
        int held = 0;
        for (int n = -patch_reach; n < count; ++n) {
            if (n + patch_reach < count) sum += static_cast<double>(at(n + patch_reach)), ++held;
            if (n - patch_reach - 1 >= 0)
                sum -= static_cast<double>(at(n - patch_reach - 1)), --held;
            if (n >= 0) to(n) = static_cast<float>(sum / held);
        }
    };
    for (int j = 0; j < values.rows; ++j)
        mean_of(
            values.width, [&](int u) { return values.row(j)[u]; },
            [&](int u) -> float& { return along.row(j)[u]; });
    for (int u = 0; u < values.width; ++u)
        mean_of(
            values.rows, [&](int j) { return along.row(j)[u]; },
            [&](int j) -> float& { return values.row(j)[u]; });
}

}  // namespace

PatchSum& PatchSum::operator+=(const PatchSum& other) {
    squares += other.squares;
    patches += other.patches;
    return *this;
}

PatchSum nearest_patches(const PlaneSamples& of, const PlaneSamples& among, float visible,
                         int moved) {
    PlaneSamples content(of.width, of.rows), nearest = content, distance = content, along = content;
    std::ranges::transform(of.values, content.values.begin(),
                           [&](float value) { return value >= visible ? 1.0f : 0.0f; });
    patch_means(content, along);
    std::ranges::fill(nearest.values, std::numeric_limits<float>::infinity());
    const int reach = moved + beyond_moved;
    for (int shift = -reach; shift <= reach; ++shift) {
        for (int j = 0; j < of.rows; ++j)
            for (int u = 0; u < of.width; ++u) {
                const int there = u + shift;
                const float other = there >= 0 && there < among.width ? among.row(j)[there] : 0,
                            differ = of.row(j)[u] - other;
                distance.row(j)[u] = differ * differ;
            }
        patch_means(distance, along);
        for (std::size_t n = 0; n < nearest.values.size(); ++n)
            nearest.values[n] = std::min(nearest.values[n], distance.values[n]);
    }
    PatchSum out;
    for (std::size_t n = 0; n < nearest.values.size(); ++n)
        if (content.values[n] > least_content)
            out += {static_cast<double>(std::max(nearest.values[n], 0.0f)), 1};
    return out;
}

}  // namespace fluidcarve
