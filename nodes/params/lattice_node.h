#pragma once

#include "carve/lattice/build.h"
#include "carve/lattice/overlap.h"
#include "graph/types/node_type.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// What happens if cells of a lattice are folded, or if it meets itself.
enum class OnFold { warn, error };

template <>
struct ChoiceNames<OnFold> {
    static constexpr std::array names = {std::pair{"warn", OnFold::warn},
                                         std::pair{"error", OnFold::error}};
};

template <>
struct ChoiceNames<Smooth> {
    static constexpr std::array names = {std::pair{"points", Smooth::points},
                                         std::pair{"directions", Smooth::directions},
                                         std::pair{"none", Smooth::none}};
};

/// The base of nodes that build lattices along a rig: they gather the rigs of all frames, give all
/// lattices the same shape, and report folds and overlaps.
class LatticeNode {
public:
    struct Params {
        Smooth smooth = Smooth::points;
        int max_iterations = 1000;
        OnFold on_fold = OnFold::warn;
    };
    struct Ports {
        Ref<Rig> rig;
        Ref<Lattice> lattice;
    };

    void run(const Params&, Ports& io, Context& context) const {
        io.lattice = std::make_shared<Lattice>(built_.at(moves_ ? context.t() : 0).lattice);
    }

protected:
    /// Takes the rig of a frame.
    void gather(const Ports& io, Context& context);
    /// Extends open rigs straight beyond ends where their content goes on.
    /// @param before, after  length by which content continues there, world units; 0: it does not
    /// @param aside          added length, so that content beside an end is covered, too
    void extend(double before, double after, double aside);
    /// Builds the lattices of all rigs, equal in shape, reports them, and warns of their faults.
    void conclude_build(const LatticeSpec& spec, OnFold on_fold, Context& context);

private:
    std::string in_frame(const Context& context, std::size_t t) const;
    /// Index of the frame with the largest value.
    template <class Value>
    std::size_t worst(Value&& value) const;
    /// Gives all frames as many planes as the longest rig has: the shape of a lattice never
    /// changes.
    void make_equal(const LatticeSpec& spec, const Context& context);
    void count_overlaps(const Context& context);
    /// Warns of smoothing only if it moved the rig by half a spacing or more: the corners of a
    /// polyline are always rounded.
    void warn_of_smoothing(const LatticeSpec& spec, const Context& context) const;
    /// @return whether any cell is folded
    bool warn_of_folds(const LatticeSpec& spec, OnFold on_fold, const Context& context) const;
    void warn_of_overlap(const LatticeSpec& spec, OnFold on_fold, const Context& context) const;
    void report(const Context& context) const;

    std::vector<Ref<Rig>> rigs_;       ///< one if it does not move
    std::vector<BuiltLattice> built_;  ///< one per rig
    std::vector<Overlap> overlaps_;    ///< of each
    bool moves_ = false;
};

/// The inputs, parameters and output that all of them declare.
template <class Node>
Declare<Node>& declare_lattice(Declare<Node>& node) {
    using Params = LatticeNode::Params;
    return node
        .param(
            "smooth", &Params::smooth,
            "What to smooth where neighbouring planes cross within the lattice: the rig's points, "
            "the planes' directions, or nothing. Smoothing repeats until no planes cross.")
        .param("max_iterations", &Params::max_iterations, Unit::none, between(0, 1e6),
               "Largest number of smoothing steps.")
        .param("on_fold", &Params::on_fold,
               "What happens if problems remain: a warning, or a failed run. Problems are folded "
               "cells, where planes cross, and voxels in several cells, where the lattice meets "
               "itself.")
        .output("lattice", &LatticeNode::Ports::lattice, "The lattice.")
        .kept();
}

}  // namespace fluidcarve
