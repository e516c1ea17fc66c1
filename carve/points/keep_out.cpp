#include "carve/points/keep_out.h"

#include "carve/field/extent.h"

#include <openvdb/tools/Interpolation.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fluidcarve {

namespace {

using openvdb::Vec3d;

/// A solid that points can leave along the gradient of its distances.
class Solid {
public:
    explicit Solid(const FloatGrid& distances)
        : distances_(distances),
          values_(distances.getConstAccessor()),
          sample_(values_, distances.transform()),
          voxel_(distances.voxelSize().x()) {}

    double operator()(const Vec3d& at) const {
        return sample_.isSample(near_place(distances_.worldToIndex(at)));
    }

    /// Moves a point to the surface. @param at  world position @return false if it is still inside
    bool leave(Vec3d& at) const {
        // Distances are exact only near flat surfaces, so that several steps may be needed.
        for (int step = 0; step < 20; ++step) {
            const double distance = (*this)(at);
            if (distance >= 0) return true;
            Vec3d slope;
            for (int d = 0; d < 3; ++d) {
                Vec3d aside(0);
                aside[d] = 0.5 * voxel_;
                slope[d] = (*this)(at + aside) - (*this)(at - aside);
            }
            if (!slope.normalize()) return false;
            at += (0.01 * voxel_ - distance) * slope;
        }
        return false;
    }

private:
    const FloatGrid& distances_;
    FloatGrid::ConstAccessor values_;
    openvdb::tools::GridSampler<FloatGrid::ConstAccessor, openvdb::tools::BoxSampler> sample_;
    double voxel_;
};

}  // namespace

KeptOut kept_out(const Points& points, const FloatGrid& solid) {
    const auto positions = points.positions();
    std::vector<PointImage> images(positions.size());
    std::atomic<std::size_t> moved = 0, stuck = 0;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, images.size(), 1024),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          const Solid ground(solid);
                          for (auto n = range.begin(); n < range.end(); ++n) {
                              images[n].source = static_cast<std::uint32_t>(n);
                              if (ground(positions[n]) >= 0) continue;
                              auto at = positions[n];
                              if (ground.leave(at)) {
                                  images[n].moved = true;
                                  images[n].position = at;
                                  ++moved;
                              } else {
                                  ++stuck;
                              }
                          }
                      });
    return {moved > 0 ? with_images(points, images) : points, moved, stuck};
}

}  // namespace fluidcarve
