#pragma once

#include "graph/types/node_type.h"
#include "nodes/params/carve_inputs.h"
#include "nodes/params/param_forms.h"
#include "nodes/solving/growth_of.h"
#include "nodes/solving/seam_node.h"

#include <utility>

namespace fluidcarve {

/// The common inputs, parameters and output of a solver node.
template <class Node>
Declare<Node>& declare_solver(Declare<Node>& node) {
    using Params = SeamNode::Params;
    using Ports = SeamNode::Ports;
    auto growth = growth_of<SeamNode, typename Declare<Node>::Params>("count", "seam");
    growth.best_effort = "best_effort";
    growth.exhausted = &SeamNode::exhausted;
    return node
        .input("energy", &Ports::energy,
               "The energy, 0 or more: seams avoid high values. It is sampled at the lattice's "
               "vertices.")
        .input("lattice", &Ports::lattice, "The space that is carved.")
        .input("field", &Ports::field,
               "The grid that is seen, such as the density; sampled at the vertices. With it, "
               "seams also pay for the edges that they leave behind (`cost: forward`), and empty "
               "space has a price (`empty`).")
        .input("protect", &Ports::protect,
               "What no seam may pass: a mask, or the active voxels of any grid (of a level set, "
               "its narrow band). A vertex is protected if any of the 8 voxels around it is set; a "
               "vertex on a voxel, if that voxel is set.")
        .input("attract", &Ports::attract,
               "What seams take first, to remove or widen an object: a mask or any grid, as for "
               "`protect`, which has precedence. An attracted vertex is worth a path through 64 "
               "vertices of the highest energy, and has no energy itself. seam.greedy looks only "
               "one step ahead, so it takes only attracted vertices beside its path.")
        .input("after", &Ports::after,
               "Seam sets and warps of this lattice that are carved before, in order. The new "
               "seams are found in the space that they leave; windows count its vertices.")
        .param(
            "axis", &Params::axis,
            "The dimension of the lattice that shrinks or grows: u or v, across the rig; w, along "
            "it: planes leave or are doubled, and what lies behind them moves along the rig; t, "
            "time: frames leave or are shown twice, at each vertex where that is seen least. "
            "remap.grids then makes the sequence shorter or longer. The lattice must stand still, "
            "and `count` and windows are frames: 0 is the first of the sequence.")
        .required("count", &Params::count, Unit::seams, any_number(),
                  "Number of seams: negative removes, positive inserts. N% is a share of the "
                  "vertices along the axis, rounded: -20% of 1920 removes 384.")
        .param("window", &Params::window, Unit::vertices, any_number(),
               "First and last vertex along the axis that seams may take, or shares, [0%, 50%], "
               "which hold for any spacing; auto is all vertices, but for vertex 0 of a lattice "
               "around its rig, where all columns meet. With a `field`, removals of frames leave "
               "the first and the last one, too: else they would only crop the shot.")
        .param("pair_window", &Params::pair_window, Unit::vertices, any_number(),
               "A second window, above the first. Each seam then comes with one of the opposite "
               "kind in this window: only the content between the two moves, and the size stays. "
               "auto is no pairs.")
        .param("static", &Params::static_,
               "Whether each seam in `window` is the same in all frames. It is then found in the "
               "sum of the energy over all frames.")
        .param("pair_static", &Params::pair_static,
               "The same for the seams in `pair_window`: for example on a river bank, which stands "
               "still beside the river.")
        .param("best_effort", &Params::best_effort,
               "What happens if there is room for fewer seams than `count`, because of `protect` "
               "or the window. false: the node fails. true: it finds as many as there is room for, "
               "perhaps none, and a warning says how many of how many, and where the next one "
               "finds no way.")
        .param("measure", &Params::measure,
               "vertex: all vertices count equally. volume: a vertex counts as much as the space "
               "around it, since in bent lattices inner cells are smaller than outer ones; "
               "reported energies follow this measure. In straight boxes both are the same.")
        .param("thickness", &Params::thickness, Unit::vertices, between(1, 10000),
               "Number of vertices that a seam takes out, or doubles, in each column. A thick seam "
               "is a slab: it runs where what lies before it looks like what lies behind it, and "
               "the two sides are joined by a fade (`join` of the remaps). So all else keeps its "
               "shape. `count` stays a number of vertices: slabs of this thickness, and a thinner "
               "one for the rest. 1: thin seams, which spread and squeeze. auto with a `field`: "
               "about as thick as its eddies are wide along the axis; 1 without one, in images, "
               "where the content is one smooth thing across the axis, where masks mark vertices, "
               "since the ways between them may be narrow, and with `static`, `cost` or `spread`, "
               "which serve thin seams.")
        .param("cost", &Params::cost,
               "backward: a seam costs the energy that it takes away. forward: it also costs the "
               "edges that it leaves behind. Wherever its removal makes two vertices of `field` "
               "neighbours, it pays for their difference (Rubinstein et al. 2008), whatever "
               "`measure` says. forward takes three times the memory. auto is forward if a `field` "
               "is connected.")
        .param("field_weight", &Params::field_weight, Unit::none, between(0, 1e4),
               "How much edges count. At 1, an edge of the mean size found in the content costs as "
               "much as the content's mean energy. So the same number serves any energy, field and "
               "resolution. Of thick seams: how much the difference of both sides counts beside "
               "the energy between them.")
        .param("empty", &Params::empty, Unit::none, between(0, 1e4),
               "Price of a vertex where `field` shows nothing (less than 2 % of its highest "
               "value), as a share of the mean price of vertices where it shows something. 1: the "
               "same price. Higher: more seams go through the content, which itself becomes "
               "narrower or wider. Lower: more seams go through the space around it. auto is 0.9. "
               "For thick seams it is as much as it takes for the content to change its width in "
               "the same measure as the lattice.")
        .param("rigidity", &Params::rigidity, Unit::none, at_least(0),
               "Cost of each step of a seam from a column to its neighbour in space, in mean "
               "energies of the content. More keeps seams straighter. Reported energies include "
               "it. auto is 0 without a `field`; with one 0.2, for thin seams of frames 2. Those "
               "pay nothing where the field shows nothing.")
        .param("rigidity_time", &Params::rigidity_time, Unit::none, at_least(0),
               "The same from frame to frame. More keeps seams steadier.")
        .param(
            "spread", &Params::spread, Unit::vertices, between(0, 1000),
            "How far a seam hands on the energy that it takes. The energy of a removed vertex goes "
            "in equal shares to the vertices within this distance on both sides along the axis "
            "(Cho et al. 2009), but not out of the window, nor to protected or attracted vertices. "
            "So seams do not bunch, and each part of the content gives in proportion to its room. "
            "0: seams run side by side where it is cheapest. auto is 3 with a `field`, 0 without. "
            "Seams of frames hand on the edges that they leave, so that a pause leaves as a whole.")
        .param("anchor", &Params::anchor,
               "What stays in place while seams move the rest: the lattice's low end, its middle, "
               "its high end, or the content of a vertex. Content moves by whole vertices, by the "
               "same number in all frames. For a vertex, the mean position of its content counts.")
        .param("bound_passes", &Params::bound_passes, Unit::none, between(0, 10000),
               "Each seam is reported with a lower bound on the least energy, so that its `gap` "
               "shows how good it is. Passes raise the bound; each takes up to twice as long as "
               "the bound without. auto is 0, and beyond 16 million energies 1, for the first seam "
               "only. Solvers that know a better bound report that one.")
        .param("finest", &Params::finest, Unit::none, between(1, 2),
               "2: seams are found at half size along all dimensions, time included. Energies are "
               "halved while frames stream by, so they take a sixteenth of the memory, and seams "
               "of the time. Each seam that is found stands for two, side by side; its energy and "
               "bound are those at half size, by column. Passages between protected vertices count "
               "from seven vertices on. 1: at full size. auto is 2 for lattices of more than 12 "
               "million vertices in a frame, and says so; else 1. Images, and seams of frames, are "
               "solved at full size.")
        .output("seams", &Ports::seams, "The seams, in the order in which they were found.")
        .promises([](const Params& params) { return SeamNode::in_time(params); }, only_remapped)
        .digests({"energy", "lattice", "field", "protect", "attract", "axis", "measure", "finest"})
        .grows(std::move(growth))
        .in_place()
        .kept()
        .version(4);
}

}  // namespace fluidcarve
