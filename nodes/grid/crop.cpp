#include "nodes/grid/crop.h"

#include "nodes/grid/each_grid.h"

#include <fmt/format.h>

namespace fluidcarve {
namespace {

struct Crop {
    struct Params {
        Vec3 min{}, max{};
    };
    struct Ports {
        Ref<Volume> source, volume;
    };

    static void check(const Params& params, NodeCheck& check) {
        for (std::size_t n = 0; n < 3; ++n)
            if (params.max[n] < params.min[n])
                check.fault("max", fmt::format("'max' is below 'min' in {}: {:.10g} < {:.10g}", "xyz"[n], params.max[n], params.min[n]));
    }

    static void run(const Params& params, Ports& io, Context&) {
        const auto at = [](const Vec3& corner) { return openvdb::Vec3d(corner[0], corner[1], corner[2]); };
        io.volume = std::make_shared<Volume>(cropped(*io.source, {at(params.min), at(params.max)}));
    }
};

}  // namespace

Volume cropped(const Volume& volume, const openvdb::BBoxd& box) {
    return each_grid(volume, [&](const auto& grid) -> openvdb::GridBase::ConstPtr {
        const auto out = grid->deepCopy();
        out->clipGrid(box);
        return out;
    });
}

NodeType grid_crop() {
    return Declare<Crop>("grid.crop", "Leaves of grids only what lies in a box.")
        .input("source", &Crop::Ports::source, "The grids, or one grid.")
        .required("min", &Crop::Params::min, Unit::world, any_number(), "Lowest corner of the box.")
        .required("max", &Crop::Params::max, Unit::world, any_number(), "Highest corner of the box.")
        .output(
            "volume", &Crop::Ports::volume,
            "The same grids. Voxels whose centres lie outside have the background and are inactive; of turned voxels, the box around the box along their axes "
            "counts. Points stay.")
        .names_as("volume", "source");
}

}  // namespace fluidcarve
