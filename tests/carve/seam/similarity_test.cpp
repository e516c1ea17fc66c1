#include "carve/seam/similarity.h"

#include <catch2/catch.hpp>

#include <functional>

using namespace fluidcarve;

namespace {

PlaneSamples plane(int width, const std::function<float(int u, int lateral)>& value) {
    PlaneSamples out(width, 20);
    for (int lateral = 0; lateral < out.rows; ++lateral)
        for (int u = 0; u < width; ++u) out.row(lateral)[u] = value(u, lateral);
    return out;
}

float noise_at(int u, int lateral) {
    return 1 +
           static_cast<float>(static_cast<unsigned>(u * 73 + lateral * 19) * 2654435761u % 100) /
               50;
}

}  // namespace

TEST_CASE(
    "patches that only moved along the axis have no distance, up to how far they may have moved") {
    const auto source = plane(60, noise_at),
               moved = plane(40, [](int u, int lateral) { return noise_at(u + 10, lateral); });
    // The rims of what moved have no patch of their own in the source.
    const auto far = nearest_patches(moved, source, 0.1f, 2),
               near = nearest_patches(moved, source, 0.1f, 6);
    CHECK(near.patches == 40 * 20);
    CHECK(near.root_mean() < 0.2 * far.root_mean());
    CHECK(nearest_patches(source, source, 0.1f, 2).root_mean() == 0);
}

TEST_CASE("a distance is that of the values, and mostly empty patches do not count") {
    // Beyond a plane there is nothing: that is further from both values than they are from each
    // other.
    const auto two = plane(30, [](int, int) { return 2.0f; }),
               three = plane(30, [](int, int) { return 3.0f; });
    CHECK(nearest_patches(two, three, 0.1f, 0).root_mean() == Approx(1).margin(1e-5));
    const auto half = plane(30, [](int u, int) { return u < 15 ? 1.0f : 0.0f; });
    // A patch counts as long as three of its nine columns have something.
    CHECK(nearest_patches(half, two, 0.1f, 0).patches == 17 * 20);
    CHECK(nearest_patches(plane(30, [](int, int) { return 0.0f; }), two, 0.1f, 0).patches == 0);
}
