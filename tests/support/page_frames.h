#pragma once

#include "carve/lattice/build.h"
#include "nodes/page/page_html.h"
#include "nodes/page/page_scene.h"
#include "tests/support/wavy_seams.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <string>

namespace fluidcarve::test {

/// A ball in a box of voxels.
inline FloatGrid::Ptr ball(int size) {
    auto out = FloatGrid::create();
    out->setName("density");
    const double middle = 0.5 * (size - 1);
    for (int x = 0; x < size; ++x)
        for (int y = 0; y < size; ++y)
            for (int z = 0; z < size; ++z)
                out->tree().setValue(
                    {x, y, z},
                    static_cast<float>(std::max(
                        0.01,
                        1 - (openvdb::Vec3d(x, y, z) - openvdb::Vec3d(middle)).length() / middle)));
    return out;
}

/// A ball in a box of so many voxels a side, with seams that wander.
inline PageFrame frame_of(int size, int seams) {
    PageFrame out;
    out.number = 1;
    out.before = ball(size);
    out.lattice = std::make_shared<Lattice>(make_box({0, 0, 0}, {size, size, size}, 1, {0, 1, 2}));
    auto set = wavy_seams(*out.lattice, Axis::u, Seams::Kind::remove, size / 2, seams, 2);
    for (std::size_t n = 0; n < set.seams.size(); ++n)
        set.seams[n].energy = n < 4 ? 1.0 : static_cast<double>(n);
    if (seams > 0) out.seams = {std::make_shared<Seams>(set)};
    return out;
}

/// The page of a frame, whose title tries to end its data.
inline std::string page_of(const PageFrame& frame) {
    PageRequest request;
    request.title = "shot.yaml </script>";
    request.grid = "density";
    request.setting = "seams.count";
    request.count = frame.seams.empty() ? 0 : 5;
    request.softness = {3, 0};
    return page_html(request.title, {page_scene(request, {frame})});
}

}  // namespace fluidcarve::test
