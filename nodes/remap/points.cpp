#include "nodes/remap/points.h"

#include "nodes/remap/carve_inputs.h"
#include "nodes/remap/geometry/points.h"
#include "nodes/remap/rim.h"

#include <nlohmann/json.hpp>

namespace fluidcarve {
namespace {

struct RemapPoints {
    struct Params {
        Auto<Count> count;
        Rim rim = Rim::cut;
        double fade = 8;
        double soft = default_soft;
        double soft_time = default_soft_time;
        double jitter = default_jitter;
    };
    struct Ports {
        Ref<Points> source;
        Ref<Lattice> lattice;
        List<Seams> seams;
        Ref<Points> points;
    };

    static void check(const Params& params, NodeCheck& check) { check_fade(params.rim, check); }

    static void run(const Params& params, Ports& io, Context& context) {
        auto map = carve_map(*io.lattice, io.seams, params.count, context, {params.soft, params.soft_time});
        if (params.rim == Rim::fade) map.fade(params.fade);
        const auto& source = *io.source;
        const auto carved = carve_points(source.positions(), source.identities(), *io.lattice, map, params.jitter);
        io.points = carved.changed() ? std::make_shared<Points>(with_images(source, carved.images)) : io.source;
        const nlohmann::ordered_json counts{{"points", source.size()}, {"moved", carved.moved}, {"deleted", carved.deleted}, {"copied", carved.copied}};
        context.report("points", {{context.per_frame() ? std::to_string(context.frame()) : "all", counts}});
    }
};

}  // namespace

NodeType remap_points() {
    return Declare<RemapPoints>("remap.points",
                                "Carves seams from points, or inserts them: moves particles, takes those away that a seam removes, and doubles "
                                "those where one is inserted.")
        .input("source", &RemapPoints::Ports::source, "The points to carve.")
        .input("lattice", &RemapPoints::Ports::lattice, "The lattice in which the seams were found. Points outside it stay bit for bit.")
        .input("seams", &RemapPoints::Ports::seams, "Seams, or a list of seam sets in the order of carving.")
        .param("count", &RemapPoints::Params::count, Unit::seams, any_number(),
               "Only the first so many seams, of the last set if there are several; the sign may be left out. Auto is all.")
        .param("rim", &RemapPoints::Params::rim, "What the carve does at the rims of the lattice, as for remap.grids: use the same for both.")
        .param("fade", &RemapPoints::Params::fade, Unit::vertices, between(1, 10000), fade_doc)
        .param("soft", &RemapPoints::Params::soft, Unit::vertices, between(0, 1000), soft_doc)
        .param("soft_time", &RemapPoints::Params::soft_time, Unit::frames, between(0, 100), soft_time_doc)
        .param("jitter", &RemapPoints::Params::jitter, Unit::vertices, between(0, 0.5),
               "How far a copy, where seams are inserted, may stand off the place that is one vertex from its original: at random, but always the same for "
               "the same point. Points that have a whole number `id` keep theirs from frame to frame; without one set 0 where copies must not tremble.")
        .output("points", &RemapPoints::Ports::points,
                "The source carved: all attributes and groups. The report's section `points` says how many were moved, deleted and copied in each frame.");
}

}  // namespace fluidcarve
