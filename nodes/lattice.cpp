#include "nodes/lattice.h"

#include "carve/base/failure.h"
#include "carve/lattice/content_reach.h"
#include "carve/lattice/lattice.h"
#include "carve/lattice/rig_extent.h"
#include "carve/volume/volume.h"
#include "formats/file/output_file.h"
#include "formats/geometry_file/wireframe.h"
#include "graph/types/node_type.h"
#include "nodes/params/lattice_node.h"
#include "nodes/params/param_forms.h"
#include "nodes/solving/foreseen.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>
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
        tell_form(form_of(spec_of(params)), ahead);
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

enum class Inverse { exact, closed_form };

}  // namespace

template <>
struct ChoiceNames<Inverse> {
    static constexpr std::array names = {std::pair{"exact", Inverse::exact},
                                         std::pair{"closed_form", Inverse::closed_form}};
};

namespace {

struct LatticeBuild : LatticeNode {
    struct Params : LatticeNode::Params {
        Auto<double> spacing;
        RigExtent extent_u, extent_v;
        bool flip_u = false;
        Inverse mapping = Inverse::exact;
    };
    struct Ports : LatticeNode::Ports {
        Optional<FloatGrid> content;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (params.spacing && !(*params.spacing > 0))
            return check.fault("spacing", "'spacing' must be above 0");
        const bool content = check.stated("content");
        if (!params.spacing && !content)
            check.fault("spacing",
                        "'spacing' takes the voxel size of 'content', and that is not connected; "
                        "connect it, or state the spacing");
        for (const auto& [name, extent] :
             {std::pair{"extent_u", params.extent_u}, std::pair{"extent_v", params.extent_v}}) {
            if (extent.shares && !content)
                check.fault(name, fmt::format("'{}' counts the width of 'content', and that is not "
                                              "connected; connect it, or state world units",
                                              name));
            else if (const auto fault = extent_fault(name, extent, params.spacing); !fault.empty())
                check.fault(name, fault);
        }
    }

    static void foresee(const Params& params, Outlook& ahead) {
        // Until the content is read, a lattice that depends on it may be anywhere.
        if (!ahead.told("content").empty() || !params.spacing) return;
        const auto most = [](const RigExtent& extent) {
            return std::max(std::abs(extent.low), std::abs(extent.high));
        };
        if (const auto* const rig = ahead.region("rig"))
            ahead.lies(widened(*rig, std::hypot(most(params.extent_u), most(params.extent_v))));
        tell_form(form_of(spec_of(params, {}, *params.spacing)), ahead);
    }

    void add(const Params&, const Ports& io, Context& context) {
        gather(io, context);
        if (!io.content) return;
        content_ = true;
        const auto reach = content_reach(*io.content, *io.rig);
        if (!reach) return;
        ++showing_;
        voxel_ = voxel_size(*io.content);
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
            extend(sum_.before, sum_.after, spacing);
        }
        for (const auto& [name, extent, width] :
             {std::tuple{"extent_u", params.extent_u, sum_.u},
              std::tuple{"extent_v", params.extent_v, sum_.v}}) {
            const auto [low, high] = extent.of(width);
            if (const auto fault = extent_fault(name, {low, high}, spacing); !fault.empty())
                throw Failure(fault);
        }
        conclude_build(spec_of(params, sum_, spacing), params.on_fold, context);
    }

private:
    /// What is wrong with an extent in world units. @param spacing  nothing: not known yet
    static std::string extent_fault(const char* name, const RigExtent& extent,
                                    const Auto<double>& spacing) {
        if (extent.high == extent.low)
            return fmt::format(
                "'{}' is {}, which is empty; for a single vertex, as for images, "
                "state less than one spacing{}",
                name, text_of(extent),
                spacing && !extent.shares
                    ? ": " + text_of(RigExtent{extent.low, extent.low + *spacing / 2, false})
                    : std::string());
        if (!spacing || extent.shares) return {};
        const double count = vertices_along(extent.of(0), *spacing);
        if (count <= most_vertices) return {};
        return fmt::format("'{}' holds {:.0f} vertices at a spacing of {:g}; {} is the most", name,
                           count, *spacing, most_vertices);
    }

    static LatticeSpec spec_of(const Params& params, const ContentReach& content, double spacing) {
        LatticeSpec out;
        out.spacing = spacing;
        out.u = params.extent_u.of(content.u);
        out.v = params.extent_v.of(content.v);
        out.flip_u = params.flip_u;
        out.closed_form = params.mapping == Inverse::closed_form;
        out.smooth = params.smooth;
        out.max_iterations = params.max_iterations;
        return out;
    }

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
                  "shares of how wide `content` is along `u`, [-150%, 150%]: its mean over the "
                  "frames, each the median of all planes that show it.")
        .required("extent_v", &Params::extent_v, Unit::world, any_number(),
                  "The same along `v`; shares count how wide it is along `v`. On the first plane, "
                  "`v` is the rig's `up`, made orthogonal "
                  "to the rig.")
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
