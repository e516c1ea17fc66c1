#include "nodes/lattice.h"

#include "carve/base/failure.h"
#include "carve/field/extent.h"
#include "carve/field/same_transform.h"
#include "carve/field/voxel_axes.h"
#include "carve/lattice/content_reach.h"
#include "carve/lattice/lattice.h"
#include "carve/lattice/rig_extent.h"
#include "carve/volume/cubes.h"
#include "formats/file/output_file.h"
#include "formats/geometry_file/wireframe.h"
#include "graph/types/node_type.h"
#include "nodes/params/box_params.h"
#include "nodes/params/build_params.h"
#include "nodes/params/lattice_node.h"
#include "nodes/payload/active_box.h"
#include "nodes/solving/foreseen.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

namespace fluidcarve {

namespace {

struct LatticeAround : LatticeNode {
    struct Params : LatticeNode::Params {
        double spacing = 0, radius = 0;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (!(params.spacing > 0)) return check.fault("spacing", "'spacing' must be above 0");
        if (vertices_along({0, params.radius}, params.spacing) < 2)
            check.fault(
                "radius",
                fmt::format("'radius' {:g} is less than the spacing, {:g}: nothing can be carved",
                            params.radius, params.spacing));
        else if (const double most = params.spacing * most_vertices / (2 * M_PI);
                 params.radius > most)
            check.fault("radius", fmt::format("'radius' {:g} takes more than {} vertices for a "
                                              "turn at a spacing of {:g}; {:.4g} is the most",
                                              params.radius, most_vertices, params.spacing, most));
    }

    static void foresee(const Params& params, Outlook& ahead) {
        if (const auto* const rig = ahead.region("rig")) ahead.lies(widened(*rig, params.radius));
        deliver_form(form_of(spec_of(params)), ahead);
    }

    void add(const Params&, const Ports& io, Context& context) { gather(io, context); }
    void finish(const Params& params, Ports&, Context& context) {
        conclude_build(spec_of(params), params.on_fold, context);
    }

private:
    static LatticeSpec spec_of(const Params& params) {
        LatticeSpec out;
        out.spacing = params.spacing;
        out.u = {0, params.radius};
        out.around = true;
        out.smooth = params.smooth;
        out.max_iterations = params.max_iterations;
        return out;
    }
};

}  // namespace

NodeType lattice_around() {
    using Params = LatticeAround::Params;
    Declare<LatticeAround> node(
        "lattice.around",
        "Builds a lattice around a rig: `u` is the distance from the rig, and `v` runs around it "
        "and closes. Seams across `u` make a trail, a jet or a column of smoke thinner or thicker "
        "from all sides. A moving rig gets one lattice per frame, each with as many planes as the "
        "longest rig needs.");
    node.input("rig", &LatticeAround::Ports::rig,
               "The path through the middle of what is carved: static, or one per frame.")
        .required("spacing", &Params::spacing, Unit::world, at_least(0),
                  "Distance between neighbouring vertices along `u` and along the rig, above 0. If "
                  "in doubt, use the voxel size. On a closed rig, the distance between planes is "
                  "adjusted so that it fits a whole number of times.")
        .required(
            "radius", &Params::radius, Unit::world, at_least(0),
            "How far the lattice reaches from the rig. It should hold the content: what lies "
            "beyond does not move. The outermost vertices stand one spacing apart along `v`.");
    return declare_lattice(node);
}

namespace {

using openvdb::Vec3d;

struct Box {
    using Params = BoxParams;
    struct Ports {
        OptionalList<AnyGrid> fit;
        Ref<Lattice> lattice;
    };

    static void check(const Params& params, NodeCheck& check) { check_params(params, check); }

    static void foresee(const Params& params, Outlook& ahead) {
        if (params.min && params.max) {
            ahead.lies(Region{{Region::Box{*params.min, *params.max}}, {}});
            deliver_form({shape_of(params)}, ahead);
        } else if (const auto* const fit = ahead.region("fit")) ahead.lies(*fit);
    }

    static std::shared_ptr<ActiveBox> digest(const Params&, const Ports& io, Context& context) {
        const auto& first = *io.fit.front()->grid;
        ActiveBox out{first.getName(), first.transform().copy(),
                      first.evalActiveVoxelBoundingBox()};
        for (std::size_t n = 1; n < io.fit.size(); ++n) {
            const auto& grid = *io.fit[n]->grid;
            const auto active = grid.evalActiveVoxelBoundingBox();
            if (active.empty()) continue;
            out.voxels.expand(voxels_among(first.transform(), active, grid.transform(),
                                           grid.getName(), context.frame()));
        }
        return std::make_shared<ActiveBox>(std::move(out));
    }

    void add(const Params&, const Ref<ActiveBox>& in, Context& context) {
        if (in->voxels.empty()) return;
        if (!in->transform->isLinear())
            throw Failure(
                fmt::format("grid '{}' has voxels of varying shape ({}) in frame {}; a box fits "
                            "voxels of one shape, as grid.resample makes them: or state 'min', "
                            "'max' and 'spacing' instead",
                            in->name, in->transform->mapType(), context.frame()));
        voxels_.require(fmt::format("grid '{}'", in->name), *in->transform, context.frame());
        name_ = in->name;
        // The container of the content may move from frame to frame.
        box_.expand(voxels_among(*voxels_.transform(), in->voxels, *in->transform, in->name,
                                 context.frame()));
    }

    void finish(const Params& params, Ports& io, Context&) {
        io.lattice = std::make_shared<Lattice>(params.min ? stated_box(params)
                                                          : fitted_box(axes_of(params.axes)));
    }

private:
    /// A vertex at each voxel of the box.
    Lattice fitted_box(const std::array<int, 3>& axes) const {
        if (!voxels_.transform())
            throw Failure(
                "the grid to fit has no active voxels in any frame; state 'min', 'max' and "
                "'spacing' instead");
        const auto& transform = *voxels_.transform();
        const auto counts = extents_of(box_);
        if (*std::ranges::max_element(counts) > most_vertices)
            throw Failure(
                fmt::format("the active voxels of grid '{}' span {}; {} along an axis is the most: "
                            "crop the grid, or state 'min', 'max' and 'spacing' of a part",
                            name_, span_text(box_), most_vertices),
                Failure::Kind::input);
        const std::array<int, 3> shape{static_cast<int>(counts[0]), static_cast<int>(counts[1]),
                                       static_cast<int>(counts[2])};
        return cubes_along_axes(transform)
                   ? make_box(transform.indexToWorld(box_.min()), in_order(axes, shape),
                              transform.voxelSize().x(), axes)
                   : turned_box(transform, shape, axes);
    }

    /// Along u, v and w, the voxels' own axes that come nearest to those of the world.
    /// @param counts  of voxels along their own axes
    Lattice turned_box(const openvdb::math::Transform& transform, const std::array<int, 3>& counts,
                       const std::array<int, 3>& axes) const {
        const VoxelAxes own(transform);
        Vec3d first;
        std::array<int, 3> shape;
        std::array<Vec3d, 3> steps;
        for (std::size_t n = 0; n < 3; ++n) {
            const int axis = own.nearest(axes[n]);
            const bool back = own.step(axis)[axes[n]] < 0;
            shape[n] = counts[static_cast<std::size_t>(axis)];
            steps[n] = own.step(axis) * (back ? -1 : 1);
            first[axis] = back ? box_.max()[axis] : box_.min()[axis];
        }
        return make_box(transform.indexToWorld(first), shape, steps);
    }

    SameVoxels voxels_;
    openvdb::CoordBBox box_;
    std::string name_;
};

}  // namespace

NodeType lattice_box() {
    return Declare<Box>("lattice.box",
                        "A straight lattice, given by its corners or fitted around the active "
                        "voxels of a grid over all frames.")
        .input("fit", &Box::Ports::fit,
               "A grid, or a list. The lattice gets a vertex at each voxel of the first one, in "
               "the box around the active voxels of all, over all frames. Replaces min, max and "
               "spacing.")
        .param("min", &Box::Params::min, Unit::world, any_number(), "Position of the first vertex.")
        .param("max", &Box::Params::max, Unit::world, any_number(),
               "Position of the last vertex, a whole number of spacings (0 or more) from `min`.")
        .param("spacing", &Box::Params::spacing, Unit::world, at_least(0),
               "Distance between neighbouring vertices; above 0.")
        .param("axes", &Box::Params::axes,
               "Which world axes are u, v and w; of turned voxels, the axes of the voxels that "
               "come nearest to them.")
        .output("lattice", &Box::Ports::lattice, "The lattice.")
        .digests({"fit"})
        .kept();
}

namespace {

struct LatticeBuild : LatticeNode {
    using Params = BuildParams;
    struct Ports : LatticeNode::Ports {
        Optional<FloatGrid> content;
    };

    static void check(const Params& params, NodeCheck& check) { check_params(params, check); }

    static void foresee(const Params& params, Outlook& ahead) {
        if (!params.spacing || params.extent_u.percent || params.extent_v.percent) return;
        deliver_form(form_of(spec_of(params, {}, *params.spacing)), ahead);
        if (!ahead.receives("content").empty()) return;  // content continues beyond the rig
        const auto most = [](const RigExtent& extent) {
            return std::max(std::abs(extent.low), std::abs(extent.high));
        };
        if (const auto* const rig = ahead.region("rig"))
            ahead.lies(widened(*rig, std::hypot(most(params.extent_u), most(params.extent_v))));
    }

    void add(const Params&, const Ports& io, Context& context) {
        gather(io, context);
        if (!io.content) return;
        content_ = true;
        const auto reach = content_reach(*io.content, *io.rig);
        if (!reach) return;
        ++showing_;
        voxel_ = shortest_edge(io.content->transform());
        sum_.u += reach->u;
        sum_.v += reach->v;
        sum_.before = std::max(sum_.before, reach->before);
        sum_.after = std::max(sum_.after, reach->after);
    }

    void finish(const Params& params, Ports&, Context& context) {
        const double spacing = params.spacing.value_or(voxel_);
        if (content_) {
            if (showing_ == 0)
                throw Failure(
                    "'content' shows nothing beside the rig in any frame: connect what "
                    "the rig runs through, or move the rig with rig.transform");
            sum_.u /= showing_;
            sum_.v /= showing_;
        }
        require_extents(params, sum_, spacing);
        const auto spec = spec_of(params, sum_, spacing);
        extend(sum_.before, sum_.after, std::max(-spec.u[0], spec.u[1]));
        conclude_build(spec, params.on_fold, context);
    }

private:
    ContentReach sum_;      ///< widths summed over the frames that show something; greatest ends
    int showing_ = 0;       ///< frames that do
    double voxel_ = 0;      ///< of the last of these, world units
    bool content_ = false;  ///< it is connected
};

}  // namespace

NodeType lattice_build() {
    using Params = LatticeBuild::Params;
    Declare<LatticeBuild> node("lattice.build",
                               "Builds a lattice along a rig. Its planes stand across the rig, at "
                               "equal distances, and do not twist. A moving rig gets one lattice "
                               "per frame, each with as many planes as the longest rig needs.");
    node.input("rig", &LatticeBuild::Ports::rig, "The path: static, or one per frame.")
        .input("content", &LatticeBuild::Ports::content,
               "What the rig runs through, such as the level set of a river: the inside of a level "
               "set, or where another grid exceeds 2 % of its greatest value, over all frames. "
               "Extents may be shares of its width, `spacing` may be left out, and an open "
               "lattice goes on straight beyond the rig's ends as far as the content does.")
        .sums({"content"})
        .param("spacing", &Params::spacing, Unit::world, at_least(0),
               "Distance between neighbouring vertices, above 0. If in doubt, use the voxel "
               "size; auto takes that of `content`. On a closed rig, the distance between planes "
               "is adjusted so that it fits a whole number of times.")
        .required("extent_u", &Params::extent_u, Unit::world, any_number(),
                  "Where the lattice begins and ends along `u`; 0 is the rig. The first vertex "
                  "lies at the lower end, the last one at most at the upper end. World units, or "
                  "shares of how wide `content` is along `u`, [-150%, 150%].")
        .required("extent_v", &Params::extent_v, Unit::world, any_number(),
                  "The same along `v`; shares count how wide it is along `v`. On the first plane, "
                  "`v` is the rig's `up`, made orthogonal to the rig.")
        .param("flip_u", &Params::flip_u,
               "Reverses `u`. Otherwise `u` is `v x w` (right-handed): it points outwards on a "
               "circle, and inwards on a loop that runs counter-clockwise seen from `up`.")
        .param("mapping", &Params::mapping,
               "How positions are located: by the true inverse, or, for comparison, by the paper's "
               "closed form and plane directions, which blur where planes turn.");
    return declare_lattice(node);
}

namespace {

struct LatticeWrite {
    struct Params {
        OutputPath path;
        Auto<int> every;
    };
    struct Ports {
        Ref<Lattice> lattice;
    };
    static void run(const Params& params, Ports& io, Context& context) {
        std::array<int, 3> every;
        for (std::size_t n = 0; n < 3; ++n)
            every[n] = params.every.value_or(every_by_default(io.lattice->shape[n]));
        write_wireframe(params.path.at(context.frame()), *io.lattice, every, context.provenance());
    }
};

}  // namespace

NodeType lattice_write() {
    return Declare<LatticeWrite>("lattice.write",
                                 "Writes a lattice as lines in an .obj file, to view it beside the "
                                 "data. Writes one file per frame if the lattice moves. Positions "
                                 "are those of the shot's world, with its axes. Blender turns OBJ "
                                 "files unless told otherwise: import them with Forward Y, Up Z.")
        .input("lattice", &LatticeWrite::Ports::lattice, "The lattice.")
        .required("path", &LatticeWrite::Params::path,
                  "The file. Needs a frame token such as #### if the lattice moves.")
        .param("every", &LatticeWrite::Params::every, Unit::vertices, between(1, most_vertices),
               "Distance between neighbouring lines, in vertices; 1 draws all. auto draws about 16 "
               "lines along each dimension.")
        .version(2);
}

}  // namespace fluidcarve
