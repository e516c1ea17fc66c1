#include "nodes/params/lattice_node.h"

#include "carve/base/failure.h"
#include "carve/rig/transform.h"
#include "carve/volume/cubes.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace fluidcarve {

namespace {

const char* kind(const Rig& rig) { return rig.closed ? "closed" : "open"; }

void warn_or_fail(OnFold on_fold, const Context& context, const std::string& message) {
    if (on_fold == OnFold::error) throw Failure(message);
    context.warn(message);
}

}  // namespace

void LatticeNode::gather(const Ports& io, Context& context) {
    if (!rigs_.empty() && rigs_.front()->closed != io.rig->closed)
        throw Failure(fmt::format("the rig is {} in frame {}, but {} in frame {}",
                                  kind(*rigs_.front()), context.frames().front(), kind(*io.rig),
                                  context.frame()));
    rigs_.push_back(io.rig);
    moves_ = moves_ || rigs_.front() != io.rig;
}

void LatticeNode::extend(double before, double after, double aside) {
    for (auto& rig : rigs_) {
        if (rig->closed) return;
        rig = std::make_shared<Rig>(
            extended(*rig, before > 0 ? before + aside : 0, after > 0 ? after + aside : 0));
    }
}

void LatticeNode::conclude_build(const LatticeSpec& spec, OnFold on_fold, Context& context) {
    if (!moves_) rigs_.resize(1);
    for (const auto& rig : rigs_) {
        context.check_cancelled();
        built_.push_back(build_lattice(*rig, spec));
    }
    make_equal(spec, context);
    count_overlaps(context);
    report(context);
    warn_of_smoothing(spec, context);
    // Voxels beside folded cells also lie in several cells: that needs no second message.
    if (!warn_of_folds(spec, on_fold, context)) warn_of_overlap(spec, on_fold, context);
}

std::string LatticeNode::in_frame(const Context& context, std::size_t t) const {
    return moves_ ? fmt::format(" in frame {}", context.frames()[t]) : "";
}

template <class Value>
std::size_t LatticeNode::worst(Value&& value) const {
    const auto less = [&](const BuiltLattice& a, const BuiltLattice& b) {
        return value(a) < value(b);
    };
    return static_cast<std::size_t>(std::ranges::max_element(built_, less) - built_.begin());
}

void LatticeNode::make_equal(const LatticeSpec& spec, const Context& context) {
    const auto planes = [](const BuiltLattice& built) { return built.lattice.shape[2]; };
    const auto longest = worst(planes),
               shortest = worst([&](const BuiltLattice&built) { return -planes(built); });
    const int most = planes(built_[longest]), least = planes(built_[shortest]);
    if (most == least) return;
    for (std::size_t t = 0; t < built_.size(); ++t) {
        context.check_cancelled();
        if (planes(built_[t]) != most) built_[t] = build_lattice(*rigs_[t], spec, most);
    }
    // Rigs that sway are never of exactly one length.
    if (built_[shortest].step > 0.95 * spec.spacing) return;
    context.warn(
        fmt::format("the rig needs {} planes in frame {}, but {} in frame {}; all frames get {} "
                    "planes, which are {:.4g} apart{} instead of {:.4g}",
                    most, context.frames()[longest], least, context.frames()[shortest], most,
                    built_[shortest].step, in_frame(context, shortest), spec.spacing));
}

void LatticeNode::count_overlaps(const Context& context) {
    const auto cubes = cubes_of(built_.front().lattice.spacing);
    for (const auto& built : built_) {
        context.check_cancelled();
        overlaps_.push_back(count_overlap(Mapping(built.lattice), *cubes));
    }
}

void LatticeNode::warn_of_smoothing(const LatticeSpec& spec, const Context& context) const {
    const auto t = worst([](const BuiltLattice& built) { return built.moved; });
    if (built_[t].moved < spec.spacing / 2) return;
    context.warn(fmt::format(
        "the rig was smoothed {} times to avoid folded cells{}, which moved it by up to {:.4g}",
        built_[t].iterations, in_frame(context, t), built_[t].moved));
}

bool LatticeNode::warn_of_folds(const LatticeSpec& spec, OnFold on_fold,
                                const Context& context) const {
    const auto t = worst([](const BuiltLattice& built) { return built.folds.cells; });
    const auto& folds = built_[t].folds;
    if (folds.cells == 0) return false;
    const auto& lattice = built_[t].lattice;
    const auto remedy =
        reaches_across(*rigs_[t], spec)
            ? fmt::format(
                  "the lattice reaches {:g} inwards, past the centre of {}, and no smoothing "
                  "repairs that: keep '{}' within the radius",
                  spec.flip_u || spec.around ? spec.u[1] : -spec.u[0], to_text(*rigs_[t]),
                  spec.around ? "radius" : "extent_u")
            : fmt::format("reduce {}, or smooth the rig more",
                          spec.around ? "'radius'" : "the extents on the inner side of the bend");
    warn_or_fail(
        on_fold, context,
        fmt::format("{} cells are folded{}, most of them ({}) between planes {} and {}: {}",
                    folds.cells, in_frame(context, t), folds.in_plane, folds.plane,
                    (folds.plane + 1) % lattice.shape[2], remedy));
    return true;
}

void LatticeNode::warn_of_overlap(const LatticeSpec& spec, OnFold on_fold,
                                  const Context& context) const {
    const auto most = std::ranges::max_element(
        overlaps_, [](const Overlap& a, const Overlap& b) { return a.voxels < b.voxels; });
    if (most->voxels == 0) return;
    const auto t = static_cast<std::size_t>(most - overlaps_.begin());
    warn_or_fail(
        on_fold, context,
        fmt::format("{} voxels, as large as the spacing, lie in several cells{}, most of them "
                    "between planes {} and {}, since the lattice overlaps itself; each is carved "
                    "only in the cell of the lowest plane: reduce {}, or keep the parts of the rig "
                    "further apart",
                    most->voxels, in_frame(context, t), most->plane,
                    (most->plane + 1) % built_[t].lattice.shape[2],
                    spec.around ? "'radius'" : "the extents"));
}

void LatticeNode::report(const Context& context) const {
    const auto& first = built_.front();
    const auto folded = worst([](const BuiltLattice& built) { return built.folds.cells; });
    const auto shortest = worst([](const BuiltLattice&built) { return -built.step; }),
               longest = worst([](const BuiltLattice&built) { return built.step; });
    const auto moved = worst([](const BuiltLattice& built) { return built.moved; });
    const auto smoothed = worst([](const BuiltLattice& built) { return built.iterations; });
    std::size_t shared = 0;
    for (const auto& overlap : overlaps_) shared = std::max(shared, overlap.voxels);
    context.report("lattices", {{"shape", first.lattice.shape},
                                {"closed", first.lattice.closed},
                                {"around", first.lattice.around},
                                {"spacing", first.lattice.spacing},
                                {"step", {built_[shortest].step, built_[longest].step}},
                                {"folded_cells", built_[folded].folds.cells},
                                {"shared_voxels", shared},
                                {"smoothed", built_[smoothed].iterations},
                                {"moved", built_[moved].moved}});
}

}  // namespace fluidcarve
