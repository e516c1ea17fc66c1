#include "nodes/remap/mesh.h"

#include "graph/text/problem.h"
#include "nodes/remap/carve_inputs.h"
#include "nodes/remap/geometry/mesh.h"
#include "nodes/remap/joining.h"
#include "nodes/remap/rim.h"

#include <fmt/format.h>

#include <algorithm>

namespace fluidcarve {
namespace {

struct RemapMesh {
    struct Params : JoinParams {
        Auto<Count> count;
        Rim rim = Rim::cut;
        double rim_fade = 8;
        bool static_ = false;
    };
    struct Ports {
        Ref<Mesh> source;
        Ref<Lattice> lattice;
        List<Seams> seams;
        Ref<Mesh> mesh;
    };

    static bool animates(const Params& params) { return !params.static_; }
    static void check(const Params& params, NodeCheck& check) {
        check_fade(params.rim, check);
        check_join(params, check);
    }

    static void run(const Params& params, Ports& io, Context& context) {
        if (context.per_frame()) {
            io.mesh = carved(params, io, context.frame(), context);
            return;
        }
        for (const int frame : io.seams.back()->frames) {
            const auto mesh = carved(params, io, frame, context);
            if (!io.mesh) io.mesh = mesh;
            const auto& [first, now] = std::mismatch(io.mesh->points.begin(), io.mesh->points.end(), mesh->points.begin());
            if (first == io.mesh->points.end()) continue;
            throw Failure(
                fmt::format("the mesh is one file for all frames, but seams move vertex {} (counted from 0) differently in frame {} than in frame {}; leave "
                            "`static` out to get one mesh per frame, or `protect` the mesh from seams with a mask.mesh",
                            now - mesh->points.begin(), frame, io.seams.back()->frames.front()));
        }
    }

private:
    static Ref<Mesh> carved(const Params& params, const Ports& io, int frame, Context& context) {
        auto map = carve_map(*io.lattice, io.seams, params.count, frame, params);
        if (map.empty()) return io.source;
        if (params.rim == Rim::fade) map.fade(params.rim_fade);
        auto out = carve_mesh(*io.source, *io.lattice, map);
        for (const auto& warning : warnings_of(out)) context.warn(warning);
        return std::make_shared<Mesh>(std::move(out.mesh));
    }
};

}  // namespace

NodeType remap_mesh() {
    using Params = RemapMesh::Params;
    using Ports = RemapMesh::Ports;
    return declare_join(
        Declare<RemapMesh>("remap.mesh",
                           "Carves a mesh as remap.grids carves volumes. Its vertices move with the space around them; faces, UVs and everything else stay.")
            .input(
                "source", &Ports::source,
                "The mesh. A mesh that is the same in all frames becomes one per frame, since seams move (see `static`). Where a seam is removed, the mesh is "
                "compressed; where one is inserted, it is stretched. Normals of the file stay as they are.")
            .input("lattice", &Ports::lattice, "The lattice in which the seams were found.")
            .input("seams", &Ports::seams, "Seams or a warp, or a list of them in the order of carving.")
            .param(
                "count", &Params::count, Unit::seams, any_number(),
                "Number of seams to carve, from the first on. If there are several sets, it counts in the last one. The sign may be left out. auto is all. A "
                "warp is "
                "carved as a whole: leave `count` out.")
            .param("rim", &Params::rim, "As in remap.grids; use the same value for both.")
            .param("rim_fade", &Params::rim_fade, Unit::vertices, between(1, 10000), fade_doc)
            .param(
                "static", &Params::static_,
                "Whether a mesh that is one file for all frames stays one file. Seams must then move it the same way in all frames; otherwise the node fails. "
                "They do so if they are the same in all frames, as in windows with `static: true`, or if they never pass through the mesh: `protect` its "
                "voxels "
                "(mask.mesh).")
            .output("mesh", &Ports::mesh, "The carved source. Vertices outside the lattice, or where nothing moves, are the same to the last bit."));
}

}  // namespace fluidcarve
