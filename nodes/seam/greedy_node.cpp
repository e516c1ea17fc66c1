#include "nodes/seam/greedy_node.h"

#include "nodes/seam/greedy.h"
#include "nodes/seam/seam_node.h"

namespace fluidcarve {

namespace {

struct Greedy : SeamNode {
    struct Params : SeamNode::Params {
        int starts = 16;
    };
    void finish(const Params& params, Ports& io, Context& context) {
        solve(params, io, context, [&](const EnergyVolume& energy, Window window, int number, const Tick& tick) {
            return greedy_seam(energy, window, number, params.starts, tick);
        });
    }
};

}  // namespace

NodeType seam_greedy() {
    Declare<Greedy> node("seam.greedy", "Seams by the paper's multi-greedy search: fast, typically 5 to 40 % above the least energy.");
    return declare_solver(node).param("starts", &Greedy::Params::starts, Unit::none, between(1, 4096), "Searches that start side by side; the cheapest wins.");
}

}  // namespace fluidcarve
