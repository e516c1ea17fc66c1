#include "nodes/grid.h"

#include "carve/grid/crop.h"
#include "carve/grid/named_grids.h"
#include "carve/grid/prune.h"
#include "carve/grid/resample.h"
#include "carve/volume/volume.h"
#include "graph/types/node_type.h"
#include "nodes/params/check_params.h"
#include "nodes/params/voxels_of.h"

#include <string>
#include <vector>

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
        check_corners(params.min, params.max, check);
    }

    static void run(const Params& params, Ports& io, Context&) {
        const openvdb::BBoxd box(openvdb::Vec3d(params.min.data()),
                                 openvdb::Vec3d(params.max.data()));
        io.volume = std::make_shared<Volume>(cropped(*io.source, box));
    }
};

}  // namespace

NodeType grid_crop() {
    return Declare<Crop>("grid.crop", "Leaves of grids only what lies in a box.")
        .input("source", &Crop::Ports::source, "The grids, or one grid.")
        .required("min", &Crop::Params::min, Unit::world, any_number(), "Lowest corner of the box.")
        .required("max", &Crop::Params::max, Unit::world, any_number(),
                  "Highest corner of the box.")
        .output("volume", &Crop::Ports::volume,
                "The same grids. Voxels whose centres lie outside have the background and are "
                "inactive; of turned voxels, the box around the box along their axes counts. "
                "Points stay.")
        .names_from("source");
}

namespace {

struct PickGrids {
    struct Params {
        std::vector<std::string> keep, drop;
    };
    struct Ports {
        Ref<Volume> source, volume;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (params.keep.empty() == params.drop.empty())
            check.fault("type", "needs either 'keep' or 'drop'");
    }

    static void run(const Params& params, Ports& io, Context&) {
        const bool keep = !params.keep.empty();
        io.volume =
            std::make_shared<Volume>(picked(*io.source, keep ? params.keep : params.drop, keep));
    }
};

}  // namespace

NodeType grid_pick() {
    return Declare<PickGrids>("grid.pick", "Keeps some grids of a volume, or drops them.")
        .input("source", &PickGrids::Ports::source, "The grids.")
        .param("keep", &PickGrids::Params::keep,
               "Names of the grids to keep, or patterns: vel* is all that begin with vel.")
        .param("drop", &PickGrids::Params::drop,
               "Names or patterns of the grids to leave out, instead of `keep`.")
        .output("volume", &PickGrids::Ports::volume, "The grids that are left, in their order.")
        .names_from("source");
}

namespace {

struct Prune {
    struct Params {
        double tolerance = 0;
        Auto<double> below;
    };
    struct Ports {
        Ref<Volume> source, volume;
    };
    static void run(const Params& params, Ports& io, Context&) {
        io.volume = std::make_shared<Volume>(pruned(*io.source, params.tolerance, params.below));
    }
};

}  // namespace

NodeType grid_prune() {
    return Declare<Prune>(
               "grid.prune",
               "Makes grids smaller: takes out what hardly shows, and joins equal voxels to tiles.")
        .input("source", &Prune::Ports::source, "The grids, or one grid.")
        .param("tolerance", &Prune::Params::tolerance, Unit::none, at_least(0),
               "Voxels that differ by no more become a tile of their median, in the unit of each "
               "grid. 0 joins only equal ones.")
        .param("below", &Prune::Params::below, Unit::none, at_least(0),
               "Values of less, or vectors of less length, become background and inactive. auto "
               "takes nothing out. Level sets are left out.")
        .output("volume", &Prune::Ports::volume, "The same grids. Points stay.")
        .names_from("source");
}

namespace {

struct Resample {
    struct Params {
        Auto<double> voxel_size;
    };
    struct Ports {
        Ref<Volume> source;
        Optional<AnyGrid> like;
        Ref<Volume> volume;
    };

    static void check(const Params& params, NodeCheck& check) {
        check_voxels(params.voxel_size, check);
    }

    static void run(const Params& params, Ports& io, Context& context) {
        const auto transform = voxels_of(io.like, params.voxel_size);
        io.volume =
            std::make_shared<Volume>(resampled(*io.source, *transform, context.limits().memory));
    }
};

}  // namespace

NodeType grid_resample() {
    return Declare<Resample>("grid.resample",
                             "Puts grids on other voxels: larger or smaller ones, upright cubes in "
                             "place of turned ones, or those of another grid.")
        .input("source", &Resample::Ports::source, "The grids, or one grid.")
        .input("like", &Resample::Ports::like,
               "The grids take the voxels of this grid. Only its transform counts.")
        .param("voxel_size", &Resample::Params::voxel_size, Unit::world, between(least_voxel, 1e9),
               "Edge of a voxel, instead of `like`. A voxel centre is at the world's origin, and "
               "voxels stand along the world's axes.")
        .output("volume", &Resample::Ports::volume,
                "The same grids. Floats and vectors are read linearly, whole numbers and states "
                "from the nearest voxel; level sets keep their narrow band. Staggered vectors "
                "become collocated. Points stay.")
        .names_from("source");
}

}  // namespace fluidcarve
