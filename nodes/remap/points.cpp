#include "nodes/remap/points.h"

#include "nodes/remap/carve_inputs.h"
#include "nodes/remap/geometry/points.h"
#include "nodes/remap/joining.h"
#include "nodes/remap/rim.h"

#include <nlohmann/json.hpp>

namespace fluidcarve {
namespace {

struct RemapPoints {
    struct Params : JoinParams {
        Auto<Count> count;
        Rim rim = Rim::cut;
        double rim_fade = 8;
        double jitter = default_jitter;
    };
    struct Ports {
        Ref<Points> source;
        Ref<Lattice> lattice;
        List<Seams> seams;
        Ref<Points> points;
    };

    static void check(const Params& params, NodeCheck& check) {
        check_fade(params.rim, check);
        check_join(params, check);
    }

    static void run(const Params& params, Ports& io, Context& context) {
        auto map = carve_map(*io.lattice, io.seams, params.count, context, params);
        if (params.rim == Rim::fade) map.fade(params.rim_fade);
        const auto& source = *io.source;
        const auto carved = carve_points(source.positions(), source.identities(), *io.lattice, map, params.jitter);
        io.points = carved.changed() ? std::make_shared<Points>(with_images(source, carved.images)) : io.source;
        const nlohmann::ordered_json counts{{"points", source.size()}, {"moved", carved.moved}, {"deleted", carved.deleted}, {"copied", carved.copied}};
        context.report("points", {{context.per_frame() ? std::to_string(context.frame()) : "all", counts}});
    }
};

}  // namespace

NodeType remap_points() {
    return declare_join(
        Declare<RemapPoints>("remap.points",
                             "Carves seams from points, or inserts them. Particles move; those that a removed seam takes are deleted, and those "
                             "where a seam is inserted are doubled.")
            .input("source", &RemapPoints::Ports::source, "The points to carve.")
            .input("lattice", &RemapPoints::Ports::lattice, "The lattice in which the seams were found. Points outside it stay bit for bit.")
            .input("seams", &RemapPoints::Ports::seams, "Seams or a warp, or a list of them in the order of carving.")
            .param(
                "count", &RemapPoints::Params::count, Unit::seams, any_number(),
                "Number of seams to carve, from the first on. If there are several sets, it counts in the last one. The sign may be left out. auto is all. A "
                "warp is "
                "carved as a whole: leave `count` out.")
            .param("rim", &RemapPoints::Params::rim, "How the carve ends at the lattice's rims, as in remap.grids; use the same value for both.")
            .param("rim_fade", &RemapPoints::Params::rim_fade, Unit::vertices, between(1, 10000), fade_doc)
            .param(
                "jitter", &RemapPoints::Params::jitter, Unit::vertices, between(0, 0.5),
                "Where seams are inserted, a copy stands one vertex from its original, plus a random offset of up to this size along each axis. The offset is "
                "always the same for the same point. It stays the same from frame to frame if points have a whole number `id`; without one, set 0 if copies "
                "must not tremble.")
            .output("points", &RemapPoints::Ports::points,
                    "The carved source, with all attributes and groups. The report's section `points` tells how many were moved, deleted and copied in each "
                    "frame."));
}

}  // namespace fluidcarve
