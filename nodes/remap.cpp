#include "nodes/remap.h"

#include "carve/base/failure.h"
#include "carve/points/point_vectors.h"
#include "carve/remap/finish/finish.h"
#include "carve/remap/finish/tears.h"
#include "carve/remap/finish/transport.h"
#include "carve/remap/geometry/mesh.h"
#include "carve/remap/geometry/points.h"
#include "carve/remap/grid.h"
#include "carve/remap/joining.h"
#include "carve/seam/carve_map.h"
#include "graph/types/node_type.h"
#include "nodes/params/remap_node.h"
#include "nodes/result/carve_result.h"
#include "nodes/solving/foreseen.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>
#include <utility>

namespace fluidcarve {

template <>
struct ChoiceNames<Interpolation> {
    static constexpr std::array names = {std::pair{"linear", Interpolation::linear},
                                         std::pair{"quadratic", Interpolation::quadratic},
                                         std::pair{"cubic", Interpolation::cubic}};
};

namespace {

enum class Conserve { none, mass };

}  // namespace

template <>
struct ChoiceNames<Conserve> {
    static constexpr std::array names = {std::pair{"none", Conserve::none},
                                         std::pair{"mass", Conserve::mass}};
};

namespace {

struct RemapGrids : RemapNode {
    struct Params : RemapNode::Params {
        Interpolation interpolation = Interpolation::linear;
        Auto<bool> renormalize;
        Conserve conserve = Conserve::none;
        std::vector<std::string> densities{"density"};
        bool transform_vectors = false;
    };
    struct Ports {
        Ref<Volume> source;
        Ref<Lattice> lattice;
        List<Seams> seams;
        Ref<Volume> volume;
    };

    static void foresee(const Params& params, Outlook& ahead) {
        if (!params.in_time) return foresee_carve(params.count, ahead);
        foresee_frames(params, idle_param(params), params.transform_vectors, ahead);
    }

    void add(const Params&, const Ports& io, Context& context) {
        frames_.add(*io.source, io.lattice, context.frame(), context.limits());
    }
    void finish(const Params& params, Ports& io, Context& context) {
        RemapNode::finish(params, io, context);
        if (frames_.blends())
            context.warn(
                "no float grid with cubic voxels shows where things move to, so that frames are "
                "blended where time changes; resample one (grid.resample), or state `join: cut`");
    }

    void run(const Params& params, Ports& io, Context& context) const {
        if (params.in_time) {
            io.volume =
                std::make_shared<Volume>(frames_.volume(context.frame(), params.transform_vectors));
            return;
        }
        const auto map = map_of(params, io, context);
        if (map.empty()) {
            io.volume = io.source;
            return;
        }
        for (const auto& tear : find_tears(*io.source, *io.lattice, map))
            context.warn(to_text(tear));
        const Finish finish{
            params.renormalize,
            params.conserve == Conserve::mass ? params.densities : std::vector<std::string>(),
            params.transform_vectors};
        const auto carved = carve_volume(*io.source, *io.lattice, map, params.interpolation);
        io.volume =
            std::make_shared<Volume>(finished(*io.source, carved, *io.lattice, map, finish));
        context.report(grids_by_frame, {{context.frame_name(), compared(*io.source, *io.volume)}});
    }

    static void conclude(const Params&, const nlohmann::ordered_json& frames, Context& context) {
        report_result(frames, context);
    }

private:
    /// A stated parameter that has no effect if frames are carved; empty: none.
    static std::string idle_param(const Params& params) {
        if (params.interpolation != Interpolation::linear) return "interpolation";
        if (params.renormalize) return "renormalize";
        if (params.conserve != Conserve::none) return "conserve";
        return idle_rim(params);
    }
};

}  // namespace

NodeType remap_grids() {
    using Params = RemapGrids::Params;
    using Ports = RemapGrids::Ports;
    return declare_remap(
               Declare<RemapGrids>("remap.grids",
                                   "Carves seams from the grids of a volume, or inserts them: all "
                                   "at once, from the untouched input.")
                   .input("source", &Ports::source, "The volume to carve, or one grid."))
        .param("interpolation", &Params::interpolation,
               "How values are read between voxels, if the lattice's vertices are not voxels.")
        .param("renormalize", &Params::renormalize,
               "Whether level sets (float or double, class level set) become distances again "
               "where they moved, with a new narrow band there; where space was squeezed, they "
               "are smoothed as much. auto: if their voxels are cubes, and their background is "
               "above 0.")
        .param("conserve", &Params::conserve,
               "mass: the grids named in `densities` become denser where space is compressed "
               "and thinner where it is stretched, so that their sum stays. A seam's share is "
               "spread over as many voxels on both sides as there are seams.")
        .param("densities", &Params::densities,
               "For `conserve`: float or double grids that hold amounts per volume, such as "
               "density and fuel, but not temperature.")
        .param("transform_vectors", &Params::transform_vectors,
               "Whether vectors turn and stretch with the space around them, as the velocities "
               "of a carved flow do. This applies to all grids of float vectors, also those in "
               "three parts, and to the velocities of points. If frames are carved, it "
               "multiplies them by how fast time goes, for motion blur. Carve colours by a "
               "node of their own.")
        .output("volume", &Ports::volume,
                "The carved source: same grids, transforms and metadata. The report tells what "
                "the carve did to each float grid, unless frames were carved. Points of carved "
                "frames go over one by one.")
        .names_from("source")
        .concludes(grids_by_frame)
        .version(4);
}

namespace {

struct RemapMesh : RemapNode {
    struct Params : RemapNode::Params {
        bool static_ = false;
    };
    struct Ports {
        Ref<Mesh> source;
        Ref<Lattice> lattice;
        List<Seams> seams;
        Ref<Mesh> mesh;
    };

    static NodeTraits traits(const Params& params) {
        auto out = RemapNode::traits(params);
        out.animates = !params.static_;
        return out;
    }
    static void foresee(const Params& params, Outlook& ahead) {
        if (!params.in_time) return foresee_part(params.count, ahead);
        foresee_frames(params, params.static_ ? "static" : idle_rim(params), false, ahead);
    }

    void finish(const Params& params, Ports& io, Context& context) {
        RemapNode::finish(params, io, context);
        if (frames_.blends())
            context.warn(
                "the faces of the mesh change, so that nothing says where its vertices move to: "
                "where time changes, the mesh is that of the frame that most places show; carve "
                "the level set that it is made of");
    }

    void run(const Params& params, Ports& io, Context& context) const {
        if (params.in_time) {
            io.mesh = std::make_shared<Mesh>(frames_.mesh(context.frame()));
            return;
        }
        if (context.per_frame()) {
            io.mesh = carved(params, io, context.frame(), context);
            return;
        }
        for (const int frame : io.seams.back()->frames) {
            const auto mesh = carved(params, io, frame, context);
            if (!io.mesh) io.mesh = mesh;
            const auto& [first, now] =
                std::mismatch(io.mesh->points.begin(), io.mesh->points.end(), mesh->points.begin());
            if (first == io.mesh->points.end()) continue;
            throw Failure(fmt::format(
                "the mesh is one file for all frames, but seams move vertex {} (counted from 0) "
                "differently in frame {} than in frame {}; leave `static` out to get one mesh per "
                "frame, or `protect` the mesh from seams with a mask.mesh",
                now - mesh->points.begin(), frame, io.seams.back()->frames.front()));
        }
    }

private:
    static Ref<Mesh> carved(const Params& params, const Ports& io, int frame, Context& context) {
        const auto map = map_of(params, io, frame);
        if (map.empty()) return io.source;
        auto out = carve_mesh(*io.source, *io.lattice, map);
        for (const auto& warning : warnings_of(out)) context.warn(warning);
        return std::make_shared<Mesh>(std::move(out.mesh));
    }
};

}  // namespace

NodeType remap_mesh() {
    using Params = RemapMesh::Params;
    using Ports = RemapMesh::Ports;
    return declare_remap(
               Declare<RemapMesh>("remap.mesh",
                                  "Carves a mesh as remap.grids carves volumes. Its vertices move "
                                  "with the space around them; faces, UVs and everything else "
                                  "stay.")
                   .input("source", &Ports::source,
                          "The mesh. A mesh that is the same in all frames becomes one per frame, "
                          "since seams move (see `static`); seams of frames can't carve it. Where "
                          "a seam is removed, the mesh is compressed; where one is inserted, it is "
                          "stretched. Normals of the file stay as they are."))
        .param("static", &Params::static_,
               "Whether a mesh that is one file for all frames stays one file. Seams must then "
               "move it the same way in all frames; otherwise the node fails. They do so if "
               "they are the same in all frames, as in windows with `static: true`, or if they "
               "never pass through the mesh: `protect` its voxels (mask.mesh).")
        .output("mesh", &Ports::mesh,
                "The carved source. Vertices outside the lattice, or where nothing moves, are "
                "the same to the last bit. If frames are carved, vertices go from frame to frame "
                "if the faces stay the same.");
}

namespace {

struct RemapPoints : RemapNode {
    struct Params : RemapNode::Params {
        double jitter = default_jitter;
        bool transform_vectors = false;
    };
    struct Ports {
        Ref<Points> source;
        Ref<Lattice> lattice;
        List<Seams> seams;
        Ref<Points> points;
    };

    static void foresee(const Params& params, Outlook& ahead) {
        if (!params.in_time) return foresee_carve(params.count, ahead);
        foresee_frames(params, idle_rim(params), params.transform_vectors, ahead);
    }

    void run(const Params& params, Ports& io, Context& context) const {
        if (params.in_time) {
            io.points =
                std::make_shared<Points>(frames_.points(context.frame(), params.transform_vectors));
            return;
        }
        const auto map = map_of(params, io, context);
        const auto& source = *io.source;
        const auto carved =
            carve_points(source.positions(), source.identities(), *io.lattice, map, params.jitter);
        io.points = io.source;
        if (carved.changed()) {
            auto points = with_images(source, carved.images);
            if (params.transform_vectors) points = turned(points, io, map, context);
            io.points = std::make_shared<Points>(std::move(points));
        }
        const nlohmann::ordered_json counts{{"points", source.size()},
                                            {"moved", carved.moved},
                                            {"deleted", carved.deleted},
                                            {"copied", carved.copied}};
        context.report("points", {{context.frame_name(), counts}});
    }

private:
    static Points turned(const Points& points, const Ports& io, const CarveMap& map,
                         Context& context) {
        if (points.size() > 0 && velocity_name(points).empty())
            context.warn(
                "'transform_vectors' finds no velocity to turn: points have none named v, "
                "vel or velocity");
        const Mapping mapping(map.extended(*io.lattice), map.reach());
        return vectors_turned(points, CarveDerivative(mapping, map));
    }
};

}  // namespace

NodeType remap_points() {
    using Params = RemapPoints::Params;
    using Ports = RemapPoints::Ports;
    return declare_remap(
               Declare<RemapPoints>("remap.points",
                                    "Carves seams from points, or inserts them. Particles move; "
                                    "those that a removed seam takes are deleted, and those where "
                                    "a seam is inserted are doubled.")
                   .input(
                       "source", &Ports::source,
                       "The points to carve. Those outside the lattice stay bit for bit. If "
                       "frames are carved, points go along their velocities, by their `id` if they "
                       "have one; those outside the lattice go over with most of the others."))
        .param("jitter", &Params::jitter, Unit::vertices, between(0, 0.5),
               "Where seams are inserted, a copy stands one vertex from its original, plus a "
               "random offset of up to this size along each axis. The offset is always the "
               "same for the same point. It stays the same from frame to frame if points have "
               "a whole number `id`; without one, set 0 if copies must not tremble.")
        .param("transform_vectors", &Params::transform_vectors,
               "Whether the velocities of points (v, vel, velocity, or what else ends so) turn "
               "and stretch with the space around them, and with time, as in remap.grids.")
        .output("points", &Ports::points,
                "The carved source, with all attributes and groups. The report's section "
                "`points` tells how many were moved, deleted and copied in each frame, unless "
                "frames were carved.");
}

}  // namespace fluidcarve
