#pragma once

#include "carve/remap/joining.h"
#include "carve/seam/carve_map.h"
#include "carve/time/frame_carve.h"
#include "carve/time/frame_carve_promise.h"
#include "graph/types/node_type.h"
#include "nodes/params/carve_inputs.h"
#include "nodes/params/join_params.h"
#include "nodes/params/rim.h"

#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// The base of nodes that carve. For seams of frames, such a node gathers the whole sequence.
class RemapNode {
public:
    struct Params : JoinParams {
        Auto<Count> count;
        Rim rim = Rim::cut;
        double rim_fade = 8;
        std::optional<FrameCarvePromise> in_time;  ///< if the seams are seams of frames
    };

    static void check(const Params& params, NodeCheck& check);
    static NodeTraits traits(const Params& params);
    void add(const Params&, const auto& io, Context& context) {
        frames_.add(io.source, io.lattice, context.frame(), context.limits());
    }
    void finish(const Params& params, auto& io, Context& context) {
        finish_frames(params, *io.seams.front(), context);
    }

protected:
    /// @param frame  a number, or the context whose frame it is
    static CarveMap map_of(const Params& params, const auto& io, const auto& frame) {
        auto out = carve_map(*io.lattice, io.seams, params.count, frame, params);
        if (params.rim == Rim::fade) out.fade_rims(params.rim_fade);
        return out;
    }
    /// @param idle  a stated parameter that has no effect if frames are carved; empty: none
    /// @param transform_vectors  as stated; false in a node that does not have it
    static void foresee_frames(const Params& params, const std::string& idle,
                               bool transform_vectors, Outlook& ahead);
    /// "rim" if `rim` is stated; else empty.
    static std::string idle_rim(const Params& params) {
        return params.rim != Rim::cut ? "rim" : "";
    }
    void finish_frames(const Params& params, const Seams& seams, Context& context);

    FrameCarve frames_;  ///< of seams of frames
};

/// Declares what all nodes that carve have in common: inputs `lattice` and `seams`, `count`, the
/// rim and the join.
template <class Node>
Declare<Node>& declare_remap(Declare<Node>& node) {
    using Ports = typename Node::Ports;
    using Params = RemapNode::Params;
    return declare_join(
        node.input("lattice", &Ports::lattice, "The lattice in which the seams were found.")
            .input("seams", &Ports::seams,
                   "Seams or a warp, or a list of them in the order of carving. Or one set of "
                   "seams of frames (`axis: t` of its solver): then the sequence gets shorter or "
                   "longer, and what follows this node has the new frames. `fade` and `soft` are "
                   "then in frames; leave out what acts within a frame, such as `rim` and "
                   "`soft_time`. With `join: cut` all is bit for bit that of a frame of the "
                   "source.")
            .param("count", &Params::count, Unit::seams, any_number(),
                   "Number of seams to carve, from the first on. If there are several sets, it "
                   "counts in the last one. The sign may be left out. auto is all. A warp is "
                   "carved as a whole: leave `count` out.")
            .param("rim", &Params::rim,
                   "How the carve ends at the lattice's rims beside the carved axis (the rims "
                   "along v if u is carved) and at open ends. cut: it stops there; content that "
                   "crosses the rim may tear, and remap.grids and remap.mesh warn of it. fade: "
                   "displacements go linearly to 0 towards the rim, and so does what a seam takes "
                   "or adds. Use the same value for all that the same seams carve.")
            .param("rim_fade", &Params::rim_fade, Unit::vertices, between(1, 10000), rim_fade_doc)
            .learns("seams", &Params::in_time));
}

}  // namespace fluidcarve
