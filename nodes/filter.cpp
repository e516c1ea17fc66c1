#include "nodes/filter.h"

#include "carve/base/failure.h"
#include "carve/field/filter.h"
#include "carve/remap/seam_filter.h"
#include "carve/seam/carve_map.h"
#include "graph/types/node_type.h"
#include "nodes/params/carve_inputs.h"
#include "nodes/solving/foreseen.h"

#include <algorithm>
#include <memory>

namespace fluidcarve {

namespace {

struct FilterSeam {
    struct Params {
        Auto<Count> count;
        FilterMode filter = FilterMode::gaussian;
        int width = 1;
    };
    struct Ports {
        Ref<Volume> source;
        Ref<Lattice> lattice;
        List<Seams> seams;
        Ref<Volume> volume;
    };
    static constexpr auto nothing_to_smooth =
        "a warp is among the `seams`, but it leaves no seams to smooth along, since it is smooth "
        "everywhere; leave this node out";

    static void foresee(const Params& params, Outlook& ahead) {
        if (receives_warp(ahead)) return ahead.fault(nothing_to_smooth);
        foresee_carve(params.count, ahead);
    }
    static void run(const Params& params, Ports& io, Context& context) {
        if (std::ranges::any_of(io.seams, [](const auto& set) { return set->warp.has_value(); }))
            throw Failure(nothing_to_smooth);
        const auto map = carve_map(*io.lattice, io.seams, params.count, context);
        if (map.empty()) io.volume = io.source;
        else
            io.volume = std::make_shared<Volume>(
                seam_filtered(*io.source, *io.lattice, map, params.filter, params.width));
    }
};

}  // namespace

NodeType filter_seam() {
    return Declare<FilterSeam>("filter.seam",
                               "Smooths a carved volume along the seams that were carved from it, "
                               "and nowhere else.")
        .input("source", &FilterSeam::Ports::source,
               "The carved volume, or one grid of it. Grids of whole numbers, booleans and masks "
               "stay as they are.")
        .input("lattice", &FilterSeam::Ports::lattice, "The lattice in which it was carved.")
        .input("seams", &FilterSeam::Ports::seams,
               "The seams that were carved, or the list of seam sets in the order of carving. No "
               "warp: it leaves no seams.")
        .param("count", &FilterSeam::Params::count, Unit::seams, any_number(),
               "The `count` with which the volume was carved. auto is all seams.")
        .param("filter", &FilterSeam::Params::filter,
               "mean: of a cube of voxels. median: of the same cube; removes specks and keeps "
               "edges. gaussian: four means in a row, within 5 % of a true Gaussian.")
        .param("width", &FilterSeam::Params::width, Unit::voxels, between(1, 8),
               "Voxels from the middle of the cube to its sides: 1 is a cube of 3 x 3 x 3 voxels.")
        .output("volume", &FilterSeam::Ports::volume,
                "The source, with filtered values at the active voxels of cells that a seam "
                "divides. All other voxels are bit for bit the same.")
        .names_from("source");
}

}  // namespace fluidcarve
