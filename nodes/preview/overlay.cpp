#include "nodes/preview/overlay.h"

#include "carve/field/extent.h"
#include "formats/geometry_file/wireframe.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace fluidcarve {

namespace {

/// Collects lines between places in the world.
class Projected {
public:
    Projected(const openvdb::math::Transform& space, View view)
        : space_(space), axes_(picture_axes(view)) {}

    /// Leaves out lines that run along the view, and those with an end that is not finite.
    void add(const openvdb::Vec3d& from, const openvdb::Vec3d& to) {
        const PictureLine line{place(from), place(to)};
        // NaN is not above either.
        if (std::hypot(line.to[0] - line.from[0], line.to[1] - line.from[1]) > 1e-6)
            lines_.push_back(line);
    }
    std::vector<PictureLine> lines() { return std::move(lines_); }

private:
    std::array<double, 2> place(const openvdb::Vec3d& world) const {
        const auto at = space_.worldToIndex(world);
        const auto near = [&](int axis) {
            return std::clamp<double>(at[axis] + 0.5, -farthest_voxel, farthest_voxel);
        };
        return {near(axes_[0]), near(axes_[1])};
    }

    const openvdb::math::Transform& space_;
    std::array<int, 2> axes_;
    std::vector<PictureLine> lines_;
};

}  // namespace

std::vector<PictureLine> lattice_lines(const Lattice& lattice,
                                       const openvdb::math::Transform& space, View view) {
    Projected out(space, view);
    const auto [columns, rows, planes] = lattice.shape;
    std::vector<std::array<int, 2>> corners{
        {0, 0}, {columns - 1, 0}, {columns - 1, rows - 1}, {0, rows - 1}};
    if (lattice.around) {
        corners.clear();
        for (int j = 0; j < rows; ++j) corners.push_back({columns - 1, j});
    }
    const auto corner = [&](std::size_t n, int k) {
        return lattice.position({static_cast<double>(corners[n][0]),
                                 static_cast<double>(corners[n][1]), static_cast<double>(k)});
    };
    for (const int k : lined_vertices(planes, every_by_default(planes)))
        for (std::size_t n = 0; n < corners.size(); ++n)
            out.add(corner(n, k), corner((n + 1) % corners.size(), k));
    // Around a rig, four lines along it are enough.
    for (std::size_t n = 0; n < corners.size(); n += (corners.size() + 3) / 4) {
        for (int k = 0; k + 1 < planes; ++k) out.add(corner(n, k), corner(n, k + 1));
        if (lattice.closed) out.add(corner(n, planes - 1), corner(n, 0));
    }
    return out.lines();
}

std::vector<PictureLine> rig_lines(const Rig& rig, const openvdb::math::Transform& space,
                                   View view) {
    Projected out(space, view);
    for (std::size_t n = 0; n + 1 < rig.points.size(); ++n)
        out.add(rig.points[n], rig.points[n + 1]);
    if (rig.closed) out.add(rig.points.back(), rig.points.front());
    return out.lines();
}

std::array<SeenDirection, 3> world_axes(const openvdb::math::Transform& space,
                                        const openvdb::Vec3d& at, View view) {
    const auto [right, up] = picture_axes(view);
    openvdb::Vec3d across(0), upwards(0);
    across[right] = upwards[up] = 1;
    const auto towards = across.cross(upwards);
    const auto here = space.indexToWorld(at);
    std::array<SeenDirection, 3> out;
    for (int n = 0; n < 3; ++n) {
        openvdb::Vec3d step(0);
        step[n] = space.voxelSize()[n];
        const auto seen = space.worldToIndex(here + step) - space.worldToIndex(here);
        const double length = seen.length();
        if (length > 0 && std::isfinite(length))
            out[static_cast<std::size_t>(n)] = {seen[right] / length, seen[up] / length,
                                                seen.dot(towards) / length};
    }
    return out;
}

}  // namespace fluidcarve
