#pragma once

#include "graph/node_type.h"
#include "nodes/field/same_transform.h"
#include "nodes/lattice/extension.h"
#include "nodes/payloads.h"
#include "nodes/remap/carve_map.h"
#include "nodes/seam/energy_slab.h"
#include "nodes/seam/find_seams.h"

#include <nlohmann/json_fwd.hpp>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fluidcarve {

template <>
struct ChoiceNames<Axis> {
    static constexpr std::array names = {std::pair{"u", Axis::u}, std::pair{"v", Axis::v}};
};

template <>
struct ChoiceNames<Measure> {
    static constexpr std::array names = {std::pair{"vertex", Measure::vertex}, std::pair{"volume", Measure::volume}};
};

/// What a seam pays for.
enum class Cost {
    backward,  ///< the energy that it takes away
    forward,   ///< besides, the edges that come to be where it was
};

template <>
struct ChoiceNames<Cost> {
    static constexpr std::array names = {std::pair{"backward", Cost::backward}, std::pair{"forward", Cost::forward}};
};

/// What every solver node takes and gives (METHOD 8), with all that does not depend on how one seam is found: windows,
/// pairs, static seams, masks, the space that other seams leave. A new solver is a FindSeam, its own parameters and
///
///     struct Mine : SeamNode {
///         struct Params : SeamNode::Params { int passes = 3; };
///         void finish(const Params& params, Ports& io, Context& context) { solve(params, io, context, my_seam...); }
///     };
///     NodeType seam_mine() {
///         Declare<Mine> node("seam.mine", "...");
///         return declare_solver(node).param("passes", &Mine::Params::passes, ...);
///     }
class SeamNode {
public:
    struct Params {
        Axis axis = Axis::u;
        Count count;
        Auto<Interval> window;
        Auto<Interval> pair_window;
        bool still = false;
        bool pair_still = false;
        Measure measure = Measure::vertex;
        Cost cost = Cost::backward;
        float field_weight = 1;
        float rigidity = 0;
        float rigidity_time = 0;
        Auto<int> bound_passes;
    };
    struct Ports {
        Ref<FloatGrid> energy;
        Ref<Lattice> lattice;
        Optional<FloatGrid> field;
        Optional<AnyGrid> protect, attract;
        OptionalList<Seams> after;
        Ref<Seams> seams;
    };

    static void check(const Params& params, NodeCheck& check);
    /// Takes one frame's energy at the lattice's vertices, and its field.
    void add(const Params& params, const Ports& io, Context& context);

protected:
    /// Finds the seams, reports them under `seams`: axis, kind, shape, and per seam energy, lower_bound, gap, wall_s and
    /// zero_share, and pair_energy and pair_lower_bound for pairs; where there are masks, how many vertices of them seams pass:
    /// attracted, protected (none), pair_attracted, pair_protected.
    void solve(const Params& params, Ports& io, Context& context, const FindSeam& find);

private:
    /// What is known before the energy is.
    struct Task {
        std::array<int, 3> shape{};  ///< I, J, K that the seams of `after` leave
        Seams::Kind kind = Seams::Kind::remove;
        int count = 0;
        Window window;
        std::optional<Window> pair_window;
    };
    static Task task_of(const Params& params, const Ports& io, const Lattice& lattice);
    Seams empty_seams(const Params& params, const Task& task, const Context& context) const;
    void sample(const Params& params, const Ports& io, const Lattice& lattice, std::span<std::uint16_t> slab);
    /// Energies and field of a frame, carved by the seams of `after`.
    void fill_slabs(std::span<const CarveStep> before, Axis axis, std::size_t t);
    /// Moves the seams found into `out`, and says in the report what each is like.
    void find_all(const Params& params, const Task& task, const Ports& io, const Context& context, const FindSeam& find, Seams& out,
                  nlohmann::ordered_json& report);
    /// How many seams are possible, and where no other finds a way.
    std::string why_no_more(const NoSeam& none, const Params& params, const Task& task, const Ports& io, const Context& context, bool in_pair_window) const;
    void warn_of_masks(Seams::Kind kind, const FoundSeams& found, const Context& context) const;

    std::vector<Ref<Lattice>> lattices_;  ///< of each frame that was added
    std::optional<EnergyVolume> energy_;
    std::vector<std::uint16_t> sampled_, sampled_field_;  ///< one frame's in the whole lattice, before `after`
    OneTransform transform_, field_transform_;
    Extension extension_;                               ///< of the lattice, where insertions reach beyond it
    std::optional<std::size_t> protected_, attracted_;  ///< vertices in all frames, before `after`; nothing: no mask
    bool any_active_ = false;
    bool any_met_ = false, field_met_ = false;
    openvdb::BBoxd active_box_;  ///< world box of all frames' active voxels
};

/// The common inputs, parameters and output of a solver node.
template <class Node>
Declare<Node>& declare_solver(Declare<Node>& node) {
    using Params = SeamNode::Params;
    using Ports = SeamNode::Ports;
    return node.input("energy", &Ports::energy, "What seams avoid, 0 or more; sampled at the lattice's vertices.")
        .input("lattice", &Ports::lattice, "The space that is carved.")
        .input("field", &Ports::field, "What is looked at for `cost: forward`: the density, or whatever is seen; sampled at the vertices.")
        .input("protect", &Ports::protect,
               "What no seam may pass: a mask, or the active voxels of any grid (of a level set, its narrow band). A vertex counts where any of the 8 voxels "
               "around it is set; if it stands on a voxel, where that voxel is.")
        .input(
            "attract", &Ports::attract,
            "What seams take first, to remove an object, or to widen one: a mask, or any grid, as `protect`, which comes before it. A vertex of it is worth a "
            "way through 64 vertices of the highest energy; it counts as no energy itself. seam.greedy, which looks no further than a step, takes only what "
            "lies beside its way.")
        .input("after", &Ports::after,
               "Seam sets of this lattice that are carved before, in their order: these seams are found in what those leave, and windows count its vertices.")
        .param("axis", &Params::axis, "The dimension of the lattice that shrinks or grows.")
        .required("count", &Params::count, Unit::seams, any_number(),
                  "Seams: negative removes, positive inserts; N% is of the vertices along the axis, rounded: -20% of 1920 removes 384.")
        .param("window", &Params::window, Unit::vertices, at_least(0), "First and last vertex along the axis that seams may take; auto is all of them.")
        .param("pair_window", &Params::pair_window, Unit::vertices, at_least(0),
               "A second window, above the first. Each seam then comes with one of the opposite kind in here, so that only what is between the two moves, and "
               "the size stays. Auto is no pairs.")
        .param("static", &Params::still, "Whether each seam in `window` is the same in all frames; it is found in the energy's sum over them.")
        .param("pair_static", &Params::pair_still, "The same for the seams in `pair_window`: a river bank that stands still beside a river.")
        .param("measure", &Params::measure,
               "vertex: each vertex counts as much; volume: as much as the space around it, since in bent lattices inner cells are smaller than outer ones. "
               "Energies are then reported so. In straight boxes both are the same.")
        .param("cost", &Params::cost,
               "backward: a seam costs the energy that it takes away. forward: besides, what it leaves behind: wherever its removal puts two vertices of "
               "`field` beside each other that were not, by how much they differ (Rubinstein et al. 2008), whatever `measure` says. Takes three times the "
               "memory.")
        .param("field_weight", &Params::field_weight, Unit::none, between(0, 1e4), "What a difference of 1 in `field` costs.")
        .param("rigidity", &Params::rigidity, Unit::none, at_least(0),
               "What each step of a seam costs, from a column to its neighbour in space; more keeps seams straighter. Reported energies include it.")
        .param("rigidity_time", &Params::rigidity_time, Unit::none, at_least(0), "The same from frame to frame; more keeps seams steadier.")
        .param("bound_passes", &Params::bound_passes, Unit::none, between(0, 10000),
               "Each seam is reported with a lower bound of the least energy, so that its `gap` shows how good it is; passes raise the bound, 10 in smoke "
               "mostly to 98 or 99 %. Auto is 0, which is quick, up to 16 million energies, and no bound beyond. Solvers that know a better one report that.")
        .output("seams", &Ports::seams, "The seams, in the order in which they were found.");
}

}  // namespace fluidcarve
