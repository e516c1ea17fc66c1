#pragma once

#include "carve/remap/joining.h"
#include "graph/types/node_type.h"

namespace fluidcarve {

/// Finds join parameters that contradict each other.
void check_join(const JoinParams& params, NodeCheck& check);

/// Declares the join parameters of a node.
template <class Node>
Declare<Node>& declare_join(Declare<Node>& node) {
    return node
        .param("join", &JoinParams::join,
               "How both sides of a seam meet. fade: they are blended. Detail is faded from one "
               "side to the other; what is wider than the eddies is squeezed or stretched around "
               "the seam. All else moves by whole vertices and keeps its shape. squeeze: the space "
               "around the seam is squeezed or stretched. cut: whole vertices are taken and added, "
               "as in classical seam carving. Meshes are always squeezed, and whole numbers never "
               "blended. auto is fade for thick seams, squeeze for thin ones. Seams of frames: "
               "squeeze goes from frame to frame faster or slower, moved along the flow; fade "
               "blends the frames of both sides. A warp is smooth by itself, and stays as it is.")
        .param("fade", &JoinParams::fade, Unit::vertices, between(1, 10000),
               "For `join: fade`: the width of the blend. auto is 1.2 thicknesses of the seams; of "
               "seams of frames 4 frames, of thick ones 2.")
        .param("soft", &JoinParams::soft, Unit::vertices, between(0, 1000),
               "For `join: squeeze`: how far the space on both sides of a seam is squeezed or "
               "stretched, along u, v and w; of seams of frames, in frames before and after. "
               "Everything further from all seams moves by whole vertices. 0 is the same as `join: "
               "cut`. auto is 3; for thick seams 1.4 thicknesses, of frames 3.")
        .param("soft_time", &JoinParams::soft_time, Unit::frames, between(0, 100),
               "The same in time: the number of frames before and after that influence how far "
               "each vertex moves.")
        .version(6);
}

}  // namespace fluidcarve
