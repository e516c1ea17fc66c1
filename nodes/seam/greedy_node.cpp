#include "nodes/seam/greedy_node.h"

#include "nodes/seam/greedy.h"
#include "nodes/seam/seam_node.h"

namespace fluidcarve {

template <>
struct ChoiceNames<Guide> {
    static constexpr std::array names = {std::pair{"cone", Guide::cone}, std::pair{"gaussian", Guide::gaussian}};
};

namespace {

struct Greedy : SeamNode {
    struct Params : SeamNode::Params {
        int starts = 16;
        Guide guide = Guide::cone;
    };
    void add(const Params& params, const Ref<FrameEnergy>& frame, Context& context) {
        if (params.guide == Guide::gaussian && !frame->lattice->closed)
            throw Failure("guide 'gaussian' leads seams through a closed lattice back to where they began, but this lattice is open; leave `guide` out");
        SeamNode::add(params, frame, context);
    }
    void finish(const Params& params, Ports& io, Context& context) {
        solve(params, io, context, [&](const EnergyVolume& energy, Window window, int number, const Tick& tick) {
            return greedy_seam(energy, window, number, params.starts, tick, params.guide);
        });
    }
};

}  // namespace

NodeType seam_greedy() {
    Declare<Greedy> node("seam.greedy", "Seams by the paper's multi-greedy search: fast, typically 5 to 40 % above the least energy.");
    return declare_solver(node)
        .param("starts", &Greedy::Params::starts, Unit::none, between(1, 4096), "Searches that start side by side; the cheapest wins.")
        .param("guide", &Greedy::Params::guide,
               "In a closed lattice, what leads a seam back to where it began: the `cone` of entries from which it can still close, or besides it the paper's "
               "`gaussian`, which also draws it there from afar. Seams close either way.");
}

}  // namespace fluidcarve
