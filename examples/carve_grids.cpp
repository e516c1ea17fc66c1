// Makes a sequence of smoke puffs narrower: grids in memory, a lattice, an energy, thick seams,
// carved grids.
#include "carve/energy/gradient.h"
#include "carve/remap/grid.h"
#include "carve/remap/joining.h"
#include "carve/solver/seam_search.h"

#include <cmath>
#include <iostream>
#include <memory>
#include <vector>

using namespace fluidcarve;

namespace {

/// A row of puffs that drift to the right.
FloatGrid::Ptr smoke(int frame) {
    const auto grid = FloatGrid::create();
    for (int puff = 0; puff < 5; ++puff) {
        const openvdb::Vec3d center(8 + 12 * puff + 0.5 * frame, 12 + 3 * (puff % 2), 12);
        const auto low = openvdb::Coord::floor(center - 6.0);
        for (auto at = openvdb::CoordBBox(low, low.offsetBy(12)).begin(); at; ++at)
            if (const double r = ((*at).asVec3d() - center).length(); r < 5)
                grid->tree().setValue(*at, static_cast<float>(std::cos(r / 5 * M_PI / 2)));
    }
    return grid;
}

int width_of(const openvdb::GridBase& grid) { return grid.evalActiveVoxelDim().x(); }

}  // namespace

int main() {
    openvdb::initialize();
    std::vector<FloatGrid::Ptr> frames;
    for (int frame = 1; frame <= 6; ++frame) frames.push_back(smoke(frame));

    // A box of vertices around all frames, one at each voxel.
    const auto lattice =
        std::make_shared<const Lattice>(make_box({0, 0, 0}, {68, 26, 26}, 1, {0, 1, 2}));

    SolverParams params;
    params.axis = Axis::u;
    params.count = {-20, true};       // a fifth of the vertices along u
    params.thickness = std::nullopt;  // as thick as the puffs are wide
    SeamSearch search(params, {1, 2, 3, 4, 5, 6});
    for (const auto& frame : frames)
        search.add(lattice, {*gradient_energy(*frame, 1), frame.get()});
    const auto seams = search.find();

    const Softness join[] = {softness_of({}, *seams)};
    for (std::size_t n = 0; n < frames.size(); ++n) {
        const CarveMap map(*lattice, {seams}, static_cast<int>(n) + 1, std::nullopt, join);
        const auto carved = carve_grid(frames[n], *lattice, map, Interpolation::linear);
        std::cout << "frame " << n + 1 << ": " << width_of(*frames[n]) << " voxels wide, then "
                  << width_of(*carved) << "\n";
    }
}
