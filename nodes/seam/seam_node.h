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
    forward,   ///< besides, the edges that come to be where it was
};

template <>
struct ChoiceNames<Cost> {
    static constexpr std::array names = {std::pair{"backward", Cost::backward}, std::pair{"forward", Cost::forward}};
};

/// `low`, `middle`, `high`, or a vertex.
template <>
struct ParamTraits<Anchor> {
    static Shape shape();
    static std::optional<Anchor> parse(const Value& value, ValueReader& reader);
    static std::string text(const Anchor& anchor);
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
    /// One frame's energy at the lattice's vertices, and its field.
    static std::shared_ptr<FrameEnergy> digest(const Params& params, const Ports& io, Context& context);
    void add(const Params& params, const Ref<FrameEnergy>& frame, Context& context);
    /// Takes seams that were found before, of the same energy and parameters but for `count`, and their report.
    void resume(const Payload& result, const nlohmann::ordered_json& entry);

    /// Seams as a result that grows (Growth): the first are the same however many are asked for.
    static std::string rest(const Params& params) { return to_text(params.count.value > 0 ? Seams::Kind::insert : Seams::Kind::remove); }
    static Extent extent(const Payload& result);
    static std::size_t wanted(const Params& params, std::size_t vertices);
    static Payload first(const Payload& result, std::size_t count, nlohmann::ordered_json& entry);
    /// What the report of a set makes worth a warning.
    static std::vector<std::string> warnings(const nlohmann::ordered_json& entry);

protected:
    using StartFrom = std::function<void(std::span<const std::uint16_t> last)>;
    /// Finds the seams, reports them under `seams`: axis, kind, shape, and per seam energy, lower_bound, gap, wall_s and
    /// zero_share, and pair_energy and pair_lower_bound for pairs; where there are masks, how many vertices of them seams pass:
    /// attracted, protected (none), pair_attracted, pair_protected; and how many attracted ones each seam leaves, attracted_left.
    /// @param start_from  for solvers that start from the seam before: Continued::start_from
    void solve(const Params& params, Ports& io, Context& context, const FindSeam& find, const StartFrom& start_from = nullptr);

    static constexpr float default_rigidity = 0.2f;                   ///< with a field
    std::chrono::milliseconds hold_after_ = std::chrono::seconds(5);  ///< least time from one Context::hold to the next

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
    /// @param budget  bytes of energies, and as many of the field, that may be held in memory
    void make_room(const std::array<int, 3>& shape, const Params& params, const Context& context, std::uint64_t budget);
    /// Brings energies and fields of all frames to where seams are found: into the space that the seams of `after` leave. Sets what
    /// seams pay, by what the frames are like before.
    void fill_frames(const Params& params, const Task& task, const Ports& io, const Context& context);
    /// What goes wrong where insertions extend the lattices, in words, or empty.
    std::string extension_fault(const Seams& found, const Ports& io, const Context& context) const;
    /// Puts the seams found into `out`, and says in the report what each is like.
    void find_all(const Params& params, const Task& task, const Ports& io, const Context& context, const FindSeam& find, const StartFrom& start_from,
                  Seams& out, nlohmann::ordered_json& report);
    /// Says of the seams of a window what they are like. @param prefix  of the names: none, or `pair_`
    void describe(const FoundSeams& found, const std::string& prefix, nlohmann::ordered_json& report) const;
    /// Of each seam with its pair, as far as they were found.
    std::vector<double> wall_s(const FoundSeams& pairs, const FoundSeams& found) const;
    /// How many seams are possible, and where no other finds a way.
    std::string why_no_more(const NoSeam& none, const Params& params, const Task& task, const Ports& io, const Context& context, bool in_pair_window) const;

    std::vector<Ref<Lattice>> lattices_;  ///< of each frame that was added
    std::optional<EnergyVolume> energy_;  ///< in the whole lattice, until fill_frames
    OneTransform transform_, field_transform_;
    std::optional<std::size_t> protected_, attracted_;  ///< vertices in all frames, before `after`; nothing: no mask
    bool forward_ = false;                              ///< whether there is a field
    bool any_active_ = false;
    bool any_met_ = false;
    openvdb::BBoxd active_box_;        ///< world box of all frames' active voxels
    Ref<Seams> before_;                ///< found by an earlier run, or null
    nlohmann::ordered_json reported_;  ///< of those
};

/// The common inputs, parameters and output of a solver node.
template <class Node>
Declare<Node>& declare_solver(Declare<Node>& node) {
    using Params = SeamNode::Params;
    using Ports = SeamNode::Ports;
    const auto params_of = [](const void* params) -> const Params& { return *static_cast<const typename Declare<Node>::Params*>(params); };
    return node.input("energy", &Ports::energy, "What seams avoid, 0 or more; sampled at the lattice's vertices.")
        .input("lattice", &Ports::lattice, "The space that is carved.")
        .input("field", &Ports::field,
               "What is looked at: the density, or whatever is seen; sampled at the vertices. With it, seams also pay for the edges that they leave behind "
               "(`cost: forward`), and empty space has a price (`empty`).")
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
               "memory. Auto is forward where a `field` is connected.")
        .param(
            "field_weight", &Params::field_weight, Unit::none, between(0, 1e4),
            "How much edges count. At 1 an edge of the mean size that content has costs as much as the mean energy of content; so the same number serves any "
            "energy, field and resolution.")
        .param(
            "empty", &Params::empty, Unit::none, between(0, 1e4),
            "What a vertex costs at which `field` shows nothing (it is below 2 % of its highest value), as a share of the mean price of those at which it "
            "shows "
            "something. 1: as much. Higher: more of the carve goes through the content, which itself becomes narrower or wider. Lower: more is taken from the "
            "space around it.")
        .param("rigidity", &Params::rigidity, Unit::none, at_least(0),
               "What each step of a seam costs, from a column to its neighbour in space, in mean energies of content; more keeps seams straighter. Reported "
               "energies include it. Auto is 0.2 with a `field`, 0 without.")
        .param("rigidity_time", &Params::rigidity_time, Unit::none, at_least(0), "The same from frame to frame; more keeps seams steadier.")
        .param("spread", &Params::spread, Unit::vertices, between(0, 1000),
               "How far a seam hands on what it takes: the energy of a vertex goes in equal shares to those within so many vertices on both sides along the "
               "axis (Cho et al. 2009), but not out of the window, nor to protected or attracted ones. So seams do not bunch, and each part of the content "
               "gives in proportion to its room. 0: seams run side by side where it is cheapest. Auto is 3 with a `field`, 0 without.")
        .param(
            "anchor", &Params::anchor,
            "What stays where it is when seams move the rest: the lattice's low end, its middle, its high end, or what is at a vertex. Content moves by whole "
            "vertices, in all frames alike; by a vertex is meant where its content is found on average.")
        .param("bound_passes", &Params::bound_passes, Unit::none, between(0, 10000),
               "Each seam is reported with a lower bound of the least energy, so that its `gap` shows how good it is; passes raise the bound, 10 in smoke "
               "mostly to 98 or 99 %. Auto is 0, which is quick, up to 16 million energies, and no bound beyond. Solvers that know a better one report that.")
        .output("seams", &Ports::seams, "The seams, in the order in which they were found.")
        .digests({"energy", "lattice", "field", "protect", "attract", "axis", "measure"})
        .grows({"count", [params_of](const void* params) { return SeamNode::rest(params_of(params)); }, &SeamNode::extent,
                [params_of](const void* params, std::size_t vertices) { return SeamNode::wanted(params_of(params), vertices); }, &SeamNode::first,
                &SeamNode::warnings})
        .kept();
}

}  // namespace fluidcarve
