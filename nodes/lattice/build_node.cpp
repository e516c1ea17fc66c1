#include "nodes/lattice/build_node.h"

#include "graph/text/problem.h"
#include "nodes/lattice/build.h"
#include "nodes/lattice/overlap.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace fluidcarve {

namespace {
enum class OnFold { warn, error };
enum class Inverse { exact, closed_form };
}  // namespace

template <>
struct ChoiceNames<OnFold> {
    static constexpr std::array names = {std::pair{"warn", OnFold::warn}, std::pair{"error", OnFold::error}};
};

template <>
struct ChoiceNames<Inverse> {
    static constexpr std::array names = {std::pair{"exact", Inverse::exact}, std::pair{"closed_form", Inverse::closed_form}};
};

template <>
struct ChoiceNames<Smooth> {
    static constexpr std::array names = {std::pair{"points", Smooth::points}, std::pair{"directions", Smooth::directions}, std::pair{"none", Smooth::none}};
};

namespace {

class LatticeBuild {
public:
    struct Params {
        double spacing = 0;
        Interval extent_u, extent_v;
        bool flip_u = false;
        Smooth smooth = Smooth::points;
        int max_iterations = 1000;
        OnFold on_fold = OnFold::warn;
        Inverse mapping = Inverse::exact;
    };
    struct Ports {
        Ref<Rig> rig;
        Ref<Lattice> lattice;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (!(params.spacing > 0)) return check.fault("spacing", "'spacing' must be above 0");
        check_extent("extent_u", params.extent_u, params.spacing, check);
        check_extent("extent_v", params.extent_v, params.spacing, check);
    }

    static void foresee(const Params& params, Outlook& ahead) {
        const auto most = [](const Interval& extent) { return std::max(std::abs(extent.low), std::abs(extent.high)); };
        if (const auto* const rig = ahead.region("rig")) ahead.lies(widened(*rig, std::hypot(most(params.extent_u), most(params.extent_v))));
    }

    void add(const Params& params, const Ports& io, Context& context) {
        context.check_cancelled();
        if (!rigs_.empty() && rigs_.front()->closed != io.rig->closed)
            throw Failure(
                fmt::format("the rig is {} in frame {}, but {} in frame {}", kind(*rigs_.front()), context.frames().front(), kind(*io.rig), context.frame()));
        rigs_.push_back(io.rig);
        built_.push_back(build_lattice(*io.rig, spec_of(params)));
        animated_ = context.per_frame();
    }

    void finish(const Params& params, Ports&, Context& context) {
        make_equal(params, context);
        count_overlaps(params, context);
        report(context);
        tell_smoothing(params, context);
        // Voxels beside folded cells lie in several cells, too: that needs no second message.
        if (!tell_folds(params, context)) tell_overlap(params, context);
    }

    void run(const Params&, Ports& io, Context& context) const { io.lattice = std::make_shared<Lattice>(built_.at(animated_ ? context.place() : 0).lattice); }

private:
    static void check_extent(const char* name, const Interval& extent, double spacing, NodeCheck& check) {
        if (extent.high == extent.low)
            check.fault(name, fmt::format("'{}' is [{:g}, {:g}], which is empty; for a single vertex, as for images, state less than one spacing: [{:g}, {:g}]",
                                          name, extent.low, extent.high, extent.low, extent.low + spacing / 2));
        else if (const double count = vertices_along({extent.low, extent.high}, spacing); count > most_vertices)
            check.fault(name, fmt::format("'{}' holds {:.0f} vertices at a spacing of {:g}; {} is the most", name, count, spacing, most_vertices));
    }

    static LatticeSpec spec_of(const Params& params) {
        return {params.spacing,       {params.extent_u.low, params.extent_u.high}, {params.extent_v.low, params.extent_v.high},
                params.flip_u,        params.mapping == Inverse::closed_form,      params.smooth,
                params.max_iterations};
    }

    static const char* kind(const Rig& rig) { return rig.closed ? "closed" : "open"; }

    std::string in_frame(const Context& context, std::size_t t) const { return animated_ ? fmt::format(" in frame {}", context.frames()[t]) : ""; }

    /// Index of the frame with the largest value.
    template <class Value>
    std::size_t worst(Value&& value) const {
        const auto less = [&](const BuiltLattice& a, const BuiltLattice& b) { return value(a) < value(b); };
        return static_cast<std::size_t>(std::max_element(built_.begin(), built_.end(), less) - built_.begin());
    }

    /// Gives all frames as many planes as the longest rig has: the shape of a lattice never changes.
    void make_equal(const Params& params, const Context& context) {
        const auto planes = [](const BuiltLattice& built) { return built.lattice.shape[2]; };
        const auto longest = worst(planes), shortest = worst([&](const BuiltLattice&built) { return -planes(built); });
        const int most = planes(built_[longest]), least = planes(built_[shortest]);
        if (most == least) return;
        for (std::size_t t = 0; t < built_.size(); ++t) {
            context.check_cancelled();
            if (planes(built_[t]) != most) built_[t] = build_lattice(*rigs_[t], spec_of(params), most);
        }
        // Rigs that sway are never of exactly one length.
        if (built_[shortest].step > 0.95 * params.spacing) return;
        context.warn(fmt::format(
            "the rig needs {} planes in frame {}, but {} in frame {}; all frames get {} planes, which are {:.4g} apart{} instead of {:.4g}", most,
            context.frames()[longest], least, context.frames()[shortest], most, built_[shortest].step, in_frame(context, shortest), params.spacing));
    }

    void count_overlaps(const Params& params, const Context& context) {
        const auto cubes = openvdb::math::Transform::createLinearTransform(params.spacing);
        for (const auto& built : built_) {
            context.check_cancelled();
            overlaps_.push_back(count_overlap(Mapping(built.lattice), *cubes));
        }
    }

    /// Warns of smoothing only if it moved the rig by half a spacing or more: the corners of a polyline are always rounded.
    void tell_smoothing(const Params& params, const Context& context) const {
        const auto t = worst([](const BuiltLattice& built) { return built.moved; });
        if (built_[t].moved < params.spacing / 2) return;
        context.warn(fmt::format("the rig was smoothed {} times to avoid folded cells{}, which moved it by up to {:.4g}", built_[t].iterations,
                                 in_frame(context, t), built_[t].moved));
    }

    /// @return whether any cell is folded
    bool tell_folds(const Params& params, const Context& context) const {
        const auto t = worst([](const BuiltLattice& built) { return built.folds.cells; });
        const auto& folds = built_[t].folds;
        if (folds.cells == 0) return false;
        const auto& lattice = built_[t].lattice;
        const auto remedy =
            reaches_across(*rigs_[t], spec_of(params))
                ? fmt::format("the lattice reaches {:g} inwards, past the centre of {}, and no smoothing repairs that: keep 'extent_u' within the radius",
                              params.flip_u ? params.extent_u.high : -params.extent_u.low, text_of(*rigs_[t]))
                : "reduce the extents on the inner side of the bend, or smooth the rig more";
        tell(params, context,
             fmt::format("{} cells are folded{}, most of them ({}) between planes {} and {}: {}", folds.cells, in_frame(context, t), folds.in_plane,
                         folds.plane, (folds.plane + 1) % lattice.shape[2], remedy));
        return true;
    }

    void tell_overlap(const Params& params, const Context& context) const {
        const auto most = std::max_element(overlaps_.begin(), overlaps_.end(), [](const Overlap& a, const Overlap& b) { return a.voxels < b.voxels; });
        if (most->voxels == 0) return;
        const auto t = static_cast<std::size_t>(most - overlaps_.begin());
        tell(params, context,
             fmt::format("{} voxels, as large as the spacing, lie in several cells{}, most of them between planes {} and {}, since the lattice overlaps "
                         "itself; each is carved only in the cell of the lowest plane: reduce the extents, or keep the parts of the rig further apart",
                         most->voxels, in_frame(context, t), most->plane, (most->plane + 1) % built_[t].lattice.shape[2]));
    }

    static void tell(const Params& params, const Context& context, const std::string& message) {
        if (params.on_fold == OnFold::error) throw Failure(message);
        context.warn(message);
    }

    void report(const Context& context) const {
        const auto& first = built_.front();
        const auto folded = worst([](const BuiltLattice& built) { return built.folds.cells; });
        const auto shortest = worst([](const BuiltLattice&built) { return -built.step; }), longest = worst([](const BuiltLattice&built) { return built.step; });
        const auto moved = worst([](const BuiltLattice& built) { return built.moved; });
        const auto smoothed = worst([](const BuiltLattice& built) { return built.iterations; });
        std::size_t shared = 0;
        for (const auto& overlap : overlaps_) shared = std::max(shared, overlap.voxels);
        context.report("lattices", {{"shape", first.lattice.shape},
                                    {"closed", first.lattice.closed},
                                    {"spacing", first.lattice.spacing},
                                    {"step", {built_[shortest].step, built_[longest].step}},
                                    {"folded_cells", built_[folded].folds.cells},
                                    {"shared_voxels", shared},
                                    {"smoothed", built_[smoothed].iterations},
                                    {"moved", built_[moved].moved}});
    }

    std::vector<Ref<Rig>> rigs_;
    std::vector<BuiltLattice> built_;  ///< one per rig
    std::vector<Overlap> overlaps_;    ///< of each
    bool animated_ = false;
};

}  // namespace

NodeType lattice_build() {
    using Params = LatticeBuild::Params;
    return Declare<LatticeBuild>(
               "lattice.build",
               "Builds a lattice along a rig. Its planes stand across the rig, at equal distances, and do not twist. A moving rig gets one lattice per frame, "
               "each with as many planes as the longest rig needs.")
        .input("rig", &LatticeBuild::Ports::rig, "The path: static, or one per frame.")
        .required("spacing", &Params::spacing, Unit::world, at_least(0),
                  "Distance between neighbouring vertices, above 0. If in doubt, use the voxel size. On a closed rig, the distance between planes is adjusted "
                  "so that it fits a whole number of times.")
        .required("extent_u", &Params::extent_u, Unit::world, any_number(),
                  "Where the lattice begins and ends along `u`; 0 is the rig. The first vertex lies at the lower end, the last one at most at the upper end.")
        .required("extent_v", &Params::extent_v, Unit::world, any_number(),
                  "The same along `v`. On the first plane, `v` is the rig's `up`, made orthogonal to the rig.")
        .param("flip_u", &Params::flip_u,
               "Reverses `u`. Otherwise `u` is `v x w` (right-handed): it points outwards on a circle, and inwards on a loop that runs counter-clockwise seen "
               "from `up`.")
        .param(
            "smooth", &Params::smooth,
            "What to smooth where neighbouring planes cross within the extents: the rig's points, the planes' directions, or nothing. Smoothing repeats until "
            "no planes cross.")
        .param("max_iterations", &Params::max_iterations, Unit::none, between(0, 1e6), "Largest number of smoothing steps.")
        .param("on_fold", &Params::on_fold,
               "What happens if problems remain: a warning, or a failed run. Problems are folded cells, where planes cross, and voxels in several cells, where "
               "the lattice meets itself.")
        .param("mapping", &Params::mapping,
               "How positions are located: by the true inverse, or, for comparison, by the paper's closed form and plane directions, which blur where planes "
               "turn.")
        .output("lattice", &LatticeBuild::Ports::lattice, "The lattice.")
        .kept();
}

}  // namespace fluidcarve
