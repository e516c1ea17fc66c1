#include "nodes/seam/pyramid_node.h"

#include "nodes/seam/pyramid.h"
#include "nodes/seam/seam_node.h"

namespace fluidcarve {

template <>
struct ChoiceNames<Quality> {
    static constexpr std::array names = {std::pair{"draft", Quality::draft}, std::pair{"normal", Quality::normal}, std::pair{"best", Quality::best}};
};

namespace {

struct PyramidNode : SeamNode {
    struct Params : SeamNode::Params {
        Quality quality = Quality::normal;
        int starts = 16;
    };
    void finish(const Params& params, Ports& io, Context& context) {
        Pyramid pyramid(params.quality, params.starts);
        solve(params, io, context, std::ref(pyramid), [&](std::span<const std::uint16_t> last) { pyramid.start_from(last); });
    }
};

}  // namespace

NodeType seam_pyramid() {
    Declare<PyramidNode> node(
        "seam.pyramid",
        "Seams from coarse to fine by minimum cuts in narrow bands: within half a percent of the least energy in real smoke and fire, a few percent in "
        "rougher energies, exact in images and small volumes, and never worse than `seam.greedy`.");
    return declare_solver(node)
        .param("quality", &PyramidNode::Params::quality,
               "How wide the bands are and how often they are cut. `draft` cuts only the coarsest energies and improves the seam line by line from there: "
               "about "
               "1 % above the least energy in real smoke and fire, nearly as fast as `seam.greedy`. `normal` does so on the finest energies beyond a million "
               "columns (vertices across the "
               "axis, times frames), and starts most seams from the last there; `best` never does.")
        .param("starts", &PyramidNode::Params::starts, Unit::none, between(1, 4096), "Searches of the greedy solver that compete; the cheapest of all wins.");
}

}  // namespace fluidcarve
