#include "nodes/seam/graph_cut.h"

#include "nodes/seam/cut/cut_seam.h"
#include "nodes/seam/declare_solver.h"

namespace fluidcarve {

namespace {

struct GraphCut : SeamNode {
    struct Params : SeamNode::Params {
        Auto<int> keyframe_interval;
        double threshold = 0;
    };
    void finish(const Params& params, Ports& io, Context& context) {
        solve(params, io, context, [&](const EnergyVolume& energy, Window window, int number, const Tick& tick) {
            const auto alive = [&] { tick(0); };
            const int frames = static_cast<int>(energy.frames()), interval = std::min(params.keyframe_interval.value_or(frames), frames);
            if (interval == frames && params.threshold == 0) return exact_seam(energy, window, number, alive);
            return keyframed_seam(energy, window, number, interval, params.threshold, alive);
        });
    }
};

}  // namespace

NodeType seam_graph_cut() {
    Declare<GraphCut> node("seam.graph_cut",
                           "Finds exact seams of least energy by a minimum cut through all vertices of all frames. Takes 40 bytes per vertex, 64 if steps cost "
                           "something. Use it for small volumes, and to judge the other solvers.");
    return declare_solver(node)
        .param("keyframe_interval", &GraphCut::Params::keyframe_interval, Unit::frames, at_least(1),
               "The paper's method for long sequences, for comparison: cuts this many frames at a time, as the frames before allow. auto is all frames; only "
               "that is exact.")
        .param("threshold", &GraphCut::Params::threshold, Unit::none, at_least(0), "The paper's pruning, for comparison: energies below this count as 0.");
}

}  // namespace fluidcarve
