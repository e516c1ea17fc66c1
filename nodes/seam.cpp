#include "nodes/seam.h"

#include "carve/base/failure.h"
#include "carve/solver/cut/cut_seam.h"
#include "carve/solver/dynamic.h"
#include "carve/solver/greedy.h"
#include "carve/solver/pyramid.h"
#include "carve/solver/search/find_seams.h"
#include "graph/types/node_type.h"
#include "nodes/solving/declare_solver.h"

#include <algorithm>
#include <array>
#include <utility>

namespace fluidcarve {

namespace {

struct Dynamic : SeamNode {
    void finish(const Params& params, Ports& io, Context& context) {
        solve(params, io, context, DynamicSeams());
    }
};

}  // namespace

NodeType seam_dynamic() {
    Declare<Dynamic> node("seam.dynamic",
                          "Finds exact seams of least energy in images, by dynamic programming. "
                          "For lattices one vertex thick, in one frame or with static seams.");
    return declare_solver(node);
}

namespace {

struct GraphCut : SeamNode {
    struct Params : SeamNode::Params {
        Auto<int> keyframe_interval;
        double threshold = 0;
    };
    void finish(const Params& params, Ports& io, Context& context) {
        solve(params, io, context,
              [&](const EnergyVolume& energy, Window window, int number, const Tick& tick) {
                  const auto check = [&] { tick(0); };
                  const int frames = static_cast<int>(energy.frames()),
                            interval = std::min(params.keyframe_interval.value_or(frames), frames);
                  if (interval == frames && params.threshold == 0)
                      return exact_seam(energy, window, number, check);
                  return keyframed_seam(energy, window, number, interval, params.threshold, check);
              });
    }
};

}  // namespace

NodeType seam_graph_cut() {
    Declare<GraphCut> node("seam.graph_cut",
                           "Finds exact seams of least energy by a minimum cut through all "
                           "vertices of all frames. Takes 40 bytes per vertex, 64 if steps cost "
                           "something. Use it for small volumes, and to judge the other solvers.");
    return declare_solver(node)
        .param("keyframe_interval", &GraphCut::Params::keyframe_interval, Unit::frames, at_least(1),
               "The paper's method for long sequences, for comparison: cuts this many frames at a "
               "time, as the frames before allow. auto is all frames; only that is exact.")
        .param("threshold", &GraphCut::Params::threshold, Unit::none, at_least(0),
               "The paper's pruning, for comparison: energies below this count as 0.");
}

template <>
struct ChoiceNames<Guide> {
    static constexpr std::array names = {std::pair{"cone", Guide::cone},
                                         std::pair{"gaussian", Guide::gaussian}};
};

namespace {

struct Greedy : SeamNode {
    struct Params : SeamNode::Params {
        int starts = 16;
        Guide guide = Guide::cone;
    };
    void add(const Params& params, const Ref<FrameEnergy>& frame, Context& context) {
        if (params.guide == Guide::gaussian && (!frame->lattice->closed || params.axis == Axis::w))
            throw Failure(
                "guide 'gaussian' leads seams through a closed lattice back to where they began, "
                "but this lattice is open; leave `guide` out");
        SeamNode::add(params, frame, context);
    }
    void finish(const Params& params, Ports& io, Context& context) {
        solve(params, io, context,
              [&](const EnergyVolume& energy, Window window, int number, const Tick& tick) {
                  return greedy_seam(energy, window, number, params.starts, tick, params.guide);
              });
    }
};

}  // namespace

NodeType seam_greedy() {
    Declare<Greedy> node("seam.greedy",
                         "Finds seams by the paper's multi-greedy search: fast, typically 5 to 50 "
                         "% above the least energy.");
    return declare_solver(node)
        .param("starts", &Greedy::Params::starts, Unit::none, between(1, 4096),
               "Number of searches that start side by side; the cheapest seam wins.")
        .param("guide", &Greedy::Params::guide,
               "How a seam through a closed lattice is led back to its start. `cone` allows only "
               "entries from which the seam can still close. `gaussian` adds the paper's Gaussian, "
               "which also draws the seam back from afar. Seams close either way.");
}

template <>
struct ChoiceNames<Quality> {
    static constexpr std::array names = {std::pair{"draft", Quality::draft},
                                         std::pair{"normal", Quality::normal},
                                         std::pair{"best", Quality::best}};
};

namespace {

struct PyramidNode : SeamNode {
    struct Params : SeamNode::Params {
        Quality quality = Quality::normal;
        int starts = Pyramid::usual_starts;
    };
    void finish(const Params& params, Ports& io, Context& context) {
        solve(params, io, context, Pyramid(params.quality, params.starts));
    }
};

}  // namespace

NodeType seam_pyramid() {
    Declare<PyramidNode> node(
        "seam.pyramid",
        "Finds seams from coarse to fine, by messages in narrow strips. They are within half a "
        "percent of the least energy in real smoke and fire, and within one or two percent in "
        "rougher energies. They are exact in images and small volumes; thin ones are never worse "
        "than those of `seam.greedy`.");
    return declare_solver(node)
        .param("quality", &PyramidNode::Params::quality,
               "How often messages are passed to and fro at each resolution: once, several times, "
               "or many times. `best` also cuts narrow bands at all of them.")
        .param("starts", &PyramidNode::Params::starts, Unit::none, between(1, 4096),
               "Number of greedy searches that compete; the cheapest seam of all wins. Thick seams "
               "have one.")
        .version(9);
}

}  // namespace fluidcarve
