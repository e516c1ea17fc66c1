#include "nodes/remap/grids.h"

#include "nodes/remap/carve_inputs.h"
#include "nodes/remap/finish/finish.h"
#include "nodes/remap/finish/tears.h"
#include "nodes/remap/grid.h"
#include "nodes/remap/joining.h"
#include "nodes/remap/result/carve_result.h"
#include "nodes/remap/rim.h"

#include <nlohmann/json.hpp>

namespace fluidcarve {

template <>
struct ChoiceNames<Interpolation> {
    static constexpr std::array names = {std::pair{"linear", Interpolation::linear}, std::pair{"quadratic", Interpolation::quadratic},
                                         std::pair{"cubic", Interpolation::cubic}};
};

namespace {

enum class Conserve { none, mass };

}  // namespace

template <>
struct ChoiceNames<Conserve> {
    static constexpr std::array names = {std::pair{"none", Conserve::none}, std::pair{"mass", Conserve::mass}};
};

namespace {

struct RemapGrids {
    struct Params : JoinParams {
        Auto<Count> count;
        Interpolation interpolation = Interpolation::linear;
        Auto<bool> renormalize;
        Conserve conserve = Conserve::none;
        std::vector<std::string> densities{"density"};
        bool transform_vectors = false;
        Rim rim = Rim::cut;
        double rim_fade = 8;
    };
    struct Ports {
        Ref<Volume> source;
        Ref<Lattice> lattice;
        List<Seams> seams;
        Ref<Volume> volume;
    };

    static void check(const Params& params, NodeCheck& check) {
        check_fade(params.rim, check);
        check_join(params, check);
    }

    static void run(const Params& params, Ports& io, Context& context) {
        auto map = carve_map(*io.lattice, io.seams, params.count, context, params);
        if (map.empty()) {
            io.volume = io.source;
            return;
        }
        if (params.rim == Rim::fade) map.fade(params.rim_fade);
        for (const auto& tear : find_tears(*io.source, *io.lattice, map)) context.warn(to_text(tear));
        const Finish finish{params.renormalize, params.conserve == Conserve::mass ? params.densities : std::vector<std::string>(), params.transform_vectors};
        const auto carved = carve_volume(*io.source, *io.lattice, map, params.interpolation);
        io.volume = std::make_shared<Volume>(finished(*io.source, carved, *io.lattice, map, finish));
        context.report(grids_by_frame, {{context.per_frame() ? std::to_string(context.frame()) : "all", compared(*io.source, *io.volume)}});
    }

    static void conclude(const Params&, const nlohmann::ordered_json& frames, Context& context) { tell_result(frames, context); }
};

}  // namespace

NodeType remap_grids() {
    return declare_join(
        Declare<RemapGrids>("remap.grids", "Carves seams from the grids of a volume, or inserts them: all at once, from the untouched input.")
            .input("source", &RemapGrids::Ports::source, "The volume to carve, or one grid.")
            .input("lattice", &RemapGrids::Ports::lattice, "The lattice in which the seams were found.")
            .input("seams", &RemapGrids::Ports::seams, "Seams or a warp, or a list of them in the order of carving.")
            .param(
                "count", &RemapGrids::Params::count, Unit::seams, any_number(),
                "Number of seams to carve, from the first on. If there are several sets, it counts in the last one. The sign may be left out. auto is all. A "
                "warp is "
                "carved as a whole: leave `count` out.")
            .param("interpolation", &RemapGrids::Params::interpolation, "How values are read between voxels, if the lattice's vertices are not voxels.")
            .param(
                "renormalize", &RemapGrids::Params::renormalize,
                "Whether level sets (float or double, class level set) become distances again where they moved, with a new narrow band there. auto: if their "
                "voxels are cubes, and their background is above 0.")
            .param("conserve", &RemapGrids::Params::conserve,
                   "mass: the grids named in `densities` become denser where space is compressed and thinner where it is stretched, so that their sum stays. A "
                   "seam's "
                   "share is spread over as many voxels on both sides as there are seams.")
            .param("densities", &RemapGrids::Params::densities,
                   "For `conserve`: float or double grids that hold amounts per volume, such as density and fuel, but not temperature.")
            .param("transform_vectors", &RemapGrids::Params::transform_vectors,
                   "Whether vectors turn and stretch with the space around them, as the velocities of a carved flow do. This applies to all grids of float "
                   "vectors, "
                   "also those in three parts: carve colours by a node of their own.")
            .param(
                "rim", &RemapGrids::Params::rim,
                "How the carve ends at the lattice's rims beside the carved axis (the rims along v if u is carved) and at open ends. cut: it stops there; "
                "content "
                "that crosses the rim may tear, and a warning says so. fade: displacements go linearly to 0 towards the rim, and so does what a seam takes or "
                "adds.")
            .param("rim_fade", &RemapGrids::Params::rim_fade, Unit::vertices, between(1, 10000), fade_doc)
            .output("volume", &RemapGrids::Ports::volume,
                    "The carved source: same grids, transforms and metadata. The report tells what the carve did to each float grid.")
            .names_as("volume", "source")
            .concludes(grids_by_frame));
}

}  // namespace fluidcarve
