#pragma once

#include "carve/remap/joining.h"
#include "carve/seam/carve_map.h"
#include "carve/time/frame_carve.h"
#include "carve/time/frame_carve_promise.h"
#include "graph/types/node_type.h"
#include "nodes/params/carve_inputs.h"
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
        bool transform_vectors = false;
        std::optional<FrameCarvePromise> in_time;  ///< if the seams are seams of frames
    };

    static void check(const Params& params, NodeCheck& check);
    static bool gathers(const Params& params) { return params.in_time.has_value(); }
    static std::vector<int> retimes(const Params& params, const std::vector<int>& frames);
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
    static void foresee_frames(const Params& params, const std::string& idle, Outlook& ahead);
    /// The parameters of all nodes that have no effect on frames.
    static std::string without_effect(const Params& params) {
        return params.rim != Rim::cut ? "rim" : "";
    }
    void finish_frames(const Params& params, const Seams& seams, Context& context);

    FrameCarve frames_;  ///< of seams of frames
};

}  // namespace fluidcarve
