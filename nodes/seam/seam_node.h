#pragma once

#include "graph/types/node_type.h"
#include "nodes/field/same_transform.h"
#include "nodes/lattice/extension.h"
#include "nodes/payloads.h"
#include "nodes/seam/energy/frame.h"
#include "nodes/seam/energy/prices.h"
#include "nodes/seam/energy/slab.h"
#include "nodes/seam/search/find_seams.h"
#include "nodes/seams/carve_map.h"

#include <nlohmann/json.hpp>

#include <chrono>
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
    forward,   ///< also the edges that it leaves behind
};

template <>
struct ChoiceNames<Cost> {
    static constexpr std::array names = {std::pair{"backward", Cost::backward}, std::pair{"forward", Cost::forward}};
};

/// An anchor is `low`, `middle`, `high`, or a vertex.
template <>
struct ParamTraits<Anchor> {
    static Shape shape();
    static std::optional<Anchor> parse(const Value& value, ValueReader& reader);
    static std::string text(const Anchor& anchor);
};

/// Base of all solver nodes (METHOD 8): their inputs and outputs, and all work that does not depend on how one seam is
/// found: windows, pairs, static seams, masks, and the space that earlier seams leave. A new solver is a FindSeam with its
/// own parameters and a node:
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
        bool static_ = false;
        bool pair_static = false;
        Measure measure = Measure::vertex;
        Auto<Cost> cost;
        float field_weight = 1;
        float empty = 0.9f;
        Auto<float> rigidity;
        Auto<float> rigidity_time;
        Auto<int> spread;
        Anchor anchor;
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
    /// One frame's energy at the lattice's vertices, with its field and masks.
    static std::shared_ptr<FrameEnergy> digest(const Params& params, const Ports& io, Context& context);
    void add(const Params& params, const Ref<FrameEnergy>& frame, Context& context);
    /// Continues from seams that were found before, with the same energy and parameters but for `count`.
    /// @param result  the seams
    /// @param entry   their report
    void resume(const Payload& result, const nlohmann::ordered_json& entry);

    /// Seams are a result that grows (Growth): the first seams do not depend on how many are asked for.
    static std::string rest(const Params& params) { return to_text(kind_asked(params.count.value)); }
    static Extent extent(const Payload& result);
    static std::size_t wanted(const Params& params, std::size_t vertices);
    static Payload first(const Payload& result, std::size_t count, nlohmann::ordered_json& entry);
    /// Warnings about a set of seams, made from its report.
    static std::vector<std::string> warnings(const nlohmann::ordered_json& entry);

protected:
    using StartFrom = std::function<void(std::span<const std::uint16_t> last)>;
    /// Finds the seams and reports them under `seams`: axis, kind and shape; per seam energy, lower_bound, gap, wall_s (seconds) and
    /// zero_share (0..1); for pairs also pair_energy and pair_lower_bound. With masks, also the number of marked vertices that each seam
    /// passes: attracted, protected (none), pair_attracted, pair_protected; and the number of attracted ones that each seam leaves,
    /// attracted_left.
    /// @param start_from  for solvers that start from the seam before: Continued::start_from
    void solve(const Params& params, Ports& io, Context& context, const FindSeam& find, const StartFrom& start_from = nullptr);

    static constexpr float default_rigidity = 0.2f;                   ///< with a field; in mean energies of content
    std::chrono::milliseconds hold_after_ = std::chrono::seconds(5);  ///< shortest time between two calls of Context::hold

private:
    /// The task of a solver, as far as it is known before the energy is.
    struct Task {
        std::array<int, 3> shape{};  ///< I, J, K that the seams of `after` leave
        Seams::Kind kind = Seams::Kind::remove;
        int count = 0;
        Window window;
        std::optional<Window> pair_window;
    };
    static Task task_of(const Params& params, const Ports& io, const Lattice& lattice);
    Seams empty_seams(const Params& params, const Task& task, const Context& context) const;
    /// Allocates the energy, and the field if there is one.
    /// @param budget  bytes of energies that may be held in memory, and as many of the field
    void make_room(const std::array<int, 3>& shape, const Params& params, const Context& context, std::uint64_t budget);
    /// Brings energies and fields of all frames into the space that the seams of `after` leave, and sets what seams pay. Prices depend on
    /// the frames before these seams are carved.
    void fill_frames(const Params& params, const Task& task, const Ports& io, const Context& context);
    /// Faults of the cells by which insertions extend the lattices, in words; empty if there are none.
    std::string extension_fault(const Seams& found, const Ports& io, const Context& context) const;
    /// Finds all seams, puts them into `out` and describes them in the report.
    void find_all(const Params& params, const Task& task, const Ports& io, const Context& context, const FindSeam& find, const StartFrom& start_from,
                  Seams& out, nlohmann::ordered_json& report);
    /// Describes the seams of a window in the report.
    /// @param prefix  of the report's names: empty or `pair_`
    void describe(const FoundSeams& found, const std::string& prefix, nlohmann::ordered_json& report) const;
    /// Seconds for each seam together with its pair, as far as they were found.
    std::vector<double> wall_s(const FoundSeams& pairs, const FoundSeams& found) const;
    /// Message of a failure: how many seams are possible, and where the next one finds no way.
    std::string why_no_more(const NoSeam& none, const Params& params, const Task& task, const Ports& io, const Context& context, bool in_pair_window) const;

    std::vector<Ref<Lattice>> lattices_;  ///< of the frames that were added
    std::optional<EnergyVolume> energy_;  ///< of the whole lattice until fill_frames(), then of the space that `after` leaves
    OneTransform transform_, field_transform_;
    std::optional<std::size_t> protected_, attracted_;  ///< number of marked vertices in all frames, before `after` is carved; nothing: no mask
    bool forward_ = false;                              ///< whether there is a field
    bool any_active_ = false;
    bool any_met_ = false;
    openvdb::BBoxd active_box_;        ///< world box of all frames' active voxels
    Ref<Seams> before_;                ///< found by an earlier run; null if there is none
    nlohmann::ordered_json reported_;  ///< report of before_
};

/// The common inputs, parameters and output of a solver node.
template <class Node>
Declare<Node>& declare_solver(Declare<Node>& node) {
    using Params = SeamNode::Params;
    using Ports = SeamNode::Ports;
    const auto params_of = [](const void* params) -> const Params& { return *static_cast<const typename Declare<Node>::Params*>(params); };
    return node.input("energy", &Ports::energy, "The energy, 0 or more: seams avoid high values. It is sampled at the lattice's vertices.")
        .input("lattice", &Ports::lattice, "The space that is carved.")
        .input("field", &Ports::field,
               "The grid that is seen, such as the density; sampled at the vertices. With it, seams also pay for the edges that they leave behind "
               "(`cost: forward`), and empty space has a price (`empty`).")
        .input(
            "protect", &Ports::protect,
            "What no seam may pass: a mask, or the active voxels of any grid (of a level set, its narrow band). A vertex is protected if any of the 8 voxels "
            "around it is set; a vertex on a voxel, if that voxel is set.")
        .input(
            "attract", &Ports::attract,
            "What seams take first, to remove or widen an object: a mask or any grid, as for `protect`, which has precedence. An attracted vertex is worth a "
            "way through 64 vertices of the highest energy, and has no energy itself. seam.greedy looks only one step ahead, so it takes only attracted "
            "vertices beside its way.")
        .input("after", &Ports::after,
               "Seam sets of this lattice that are carved before, in order. The new seams are found in the space that they leave; windows count its vertices.")
        .param("axis", &Params::axis, "The dimension of the lattice that shrinks or grows.")
        .required("count", &Params::count, Unit::seams, any_number(),
                  "Number of seams: negative removes, positive inserts. N% is a share of the vertices along the axis, rounded: -20% of 1920 removes 384.")
        .param("window", &Params::window, Unit::vertices, at_least(0), "First and last vertex along the axis that seams may take; auto is all vertices.")
        .param(
            "pair_window", &Params::pair_window, Unit::vertices, at_least(0),
            "A second window, above the first. Each seam then comes with one of the opposite kind in this window: only the content between the two moves, and "
            "the size stays. auto is no pairs.")
        .param("static", &Params::static_,
               "Whether each seam in `window` is the same in all frames. It is then found in the sum of the energy over all frames.")
        .param("pair_static", &Params::pair_static,
               "The same for the seams in `pair_window`: for example on a river bank, which stands still beside the river.")
        .param(
            "measure", &Params::measure,
            "vertex: all vertices count equally. volume: a vertex counts as much as the space around it, since in bent lattices inner cells are smaller than "
            "outer ones; reported energies follow this measure. In straight boxes both are the same.")
        .param("cost", &Params::cost,
               "backward: a seam costs the energy that it takes away. forward: it also costs the edges that it leaves behind. Wherever its removal makes two "
               "vertices of `field` neighbours, it pays for their difference (Rubinstein et al. 2008), whatever `measure` says. forward takes three times the "
               "memory. auto is forward if a `field` is connected.")
        .param(
            "field_weight", &Params::field_weight, Unit::none, between(0, 1e4),
            "How much edges count. At 1, an edge of the mean size found in the content costs as much as the content's mean energy. So the same number serves "
            "any energy, field and resolution.")
        .param("empty", &Params::empty, Unit::none, between(0, 1e4),
               "Price of a vertex where `field` shows nothing (less than 2 % of its highest value), as a share of the mean price of vertices where it shows "
               "something. 1: the same price. Higher: more seams go through the content, which itself becomes narrower or wider. Lower: more seams go through "
               "the space around it.")
        .param("rigidity", &Params::rigidity, Unit::none, at_least(0),
               "Cost of each step of a seam from a column to its neighbour in space, in mean energies of the content. More keeps seams straighter. Reported "
               "energies include it. auto is 0.2 with a `field`, 0 without.")
        .param("rigidity_time", &Params::rigidity_time, Unit::none, at_least(0), "The same from frame to frame. More keeps seams steadier.")
        .param("spread", &Params::spread, Unit::vertices, between(0, 1000),
               "How far a seam hands on the energy that it takes. The energy of a removed vertex goes in equal shares to the vertices within this distance on "
               "both sides along the axis (Cho et al. 2009), but not out of the window, nor to protected or attracted vertices. So seams do not bunch, and "
               "each part of the content gives in proportion to its room. 0: seams run side by side where it is cheapest. auto is 3 with a `field`, 0 without.")
        .param("anchor", &Params::anchor,
               "What stays in place while seams move the rest: the lattice's low end, its middle, its high end, or the content of a vertex. Content moves by "
               "whole vertices, by the same number in all frames. For a vertex, the mean position of its content counts.")
        .param("bound_passes", &Params::bound_passes, Unit::none, between(0, 10000),
               "Each seam is reported with a lower bound on the least energy, so that its `gap` shows how good it is. Passes raise the bound: 10 passes mostly "
               "reach 98 or 99 % in smoke. auto is 0 passes, which is quick, up to 16 million energies, and no bound beyond. Solvers that know a better bound "
               "report that one.")
        .output("seams", &Ports::seams, "The seams, in the order in which they were found.")
        .digests({"energy", "lattice", "field", "protect", "attract", "axis", "measure"})
        .grows({"count", [params_of](const void* params) { return SeamNode::rest(params_of(params)); }, &SeamNode::extent,
                [params_of](const void* params, std::size_t vertices) { return SeamNode::wanted(params_of(params), vertices); }, &SeamNode::first,
                &SeamNode::warnings})
        .kept();
}

}  // namespace fluidcarve
