#include "nodes/points/keep_out.h"

#include "graph/types/node_type.h"

#include <openvdb/tools/Interpolation.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <atomic>

namespace fluidcarve {
namespace {

using openvdb::Vec3d;

/// A solid that points can leave along the gradient of its distances.
class Solid {
public:
    explicit Solid(const FloatGrid& distances)
        : values_(distances.getConstAccessor()), sample_(values_, distances.transform()), voxel_(distances.voxelSize().x()) {}

    double operator()(const Vec3d& at) const { return static_cast<double>(sample_.wsSample(at)); }

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
    FloatGrid::ConstAccessor values_;
    openvdb::tools::GridSampler<FloatGrid::ConstAccessor, openvdb::tools::BoxSampler> sample_;
    double voxel_;
};

struct KeepOut {
    struct Params {};
    struct Ports {
        Ref<Points> source;
        Ref<FloatGrid> solid;
        Ref<Points> points;
    };
    static void run(const Params&, Ports& io, Context& context) {
        if (io.solid->getGridClass() != openvdb::GRID_LEVEL_SET)
            throw Failure(fmt::format("grid '{}' is no level set and does not say where it is solid; make one, by sdf.from_mesh for one", io.solid->getName()));
        auto kept = kept_out(*io.source, *io.solid);
        const nlohmann::ordered_json counts{{"points", io.source->size()}, {"moved", kept.moved}, {"stuck", kept.stuck}};
        context.report("points", {{context.per_frame() ? std::to_string(context.frame()) : "all", counts}});
        if (kept.stuck > 0)
            context.warn("some points lie so deep in the solid that its distances do not say which way is out, and stay; give it a wider `half_width`");
        io.points = kept.moved > 0 ? std::make_shared<Points>(std::move(kept.points)) : io.source;
    }
};

}  // namespace

KeptOut kept_out(const Points& points, const FloatGrid& solid) {
    const auto positions = points.positions();
    std::vector<PointImage> images(positions.size());
    std::atomic<std::size_t> moved = 0, stuck = 0;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, images.size(), 1024), [&](const tbb::blocked_range<std::size_t>& range) {
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

NodeType points_keep_out() {
    return Declare<KeepOut>("points.keep_out",
                            "Moves particles inside a solid out to its surface, for example where a carve moved water and bank by slightly different amounts.")
        .input("source", &KeepOut::Ports::source, "The particles. Those outside of the solid stay bit for bit.")
        .input("solid", &KeepOut::Ports::solid, "A level set, negative inside, such as sdf.from_mesh of the carved bank.")
        .output("points", &KeepOut::Ports::points,
                "The particles. None is in the solid, except those too deep in it for its narrow band to show the way out. The report's section `points` "
                "counts moved and stuck particles.");
}

}  // namespace fluidcarve
