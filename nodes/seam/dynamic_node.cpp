#include "nodes/seam/dynamic_node.h"

#include "nodes/seam/dynamic.h"
#include "nodes/seam/seam_node.h"

namespace fluidcarve {

namespace {

struct Dynamic : SeamNode {
    void finish(const Params& params, Ports& io, Context& context) { solve(params, io, context, dynamic_seam); }
};

}  // namespace

NodeType seam_dynamic() {
    Declare<Dynamic> node("seam.dynamic",
                          "Seams of least energy in images, exactly, by dynamic programming: for lattices one vertex thick, in one frame or static.");
    return declare_solver(node);
}

}  // namespace fluidcarve
