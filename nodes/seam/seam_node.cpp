#include "nodes/seam/seam_node.h"

#include "nodes/seam/carve_energy.h"
#include "nodes/seam/column_places.h"
#include "nodes/seam/lower_bound.h"
#include "nodes/seam/marks.h"
#include "nodes/seam/strip.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <tuple>

namespace fluidcarve {

namespace {

/// Up to so many energies a bound takes no longer than a search.
constexpr std::size_t most_entries_bounded = std::size_t{1} << 24;

std::string text(const openvdb::BBoxd& box) {
    return fmt::format("({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g})", box.min().x(), box.min().y(), box.min().z(), box.max().x(), box.max().y(), box.max().z());
}

std::string text(const Interval& window) { return fmt::format("[{:g}, {:g}]", window.low, window.high); }

Window window_of(const char* name, const Auto<Interval>& window, int size, Axis axis, bool after) {
    if (!window) return {0, size - 1};
    if (window->high > size - 1)
        throw Failure(fmt::format("{} {} leaves the lattice, which has {} vertices along {}{}: 0 to {}", name, text(*window), size, to_text(axis),
                                  after ? " once the seams of `after` are carved" : "", size - 1));
    return {static_cast<int>(window->low), static_cast<int>(window->high)};
}

std::size_t vertices(const std::array<int, 3>& shape) {
    return static_cast<std::size_t>(shape[0]) * static_cast<std::size_t>(shape[1]) * static_cast<std::size_t>(shape[2]);
}

/// Where a vertex of the space that seams carved before leave stands in the lattice; an inserted one halfway between two.
openvdb::Vec3d original_vertex(const std::vector<CarveStep>& steps, openvdb::Vec3d at) {
    for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
        const auto whole = [&](int axis) { return static_cast<int>(std::floor(at[axis])); };
        at[step->axis()] += 0.5 * step->displacement(whole(step->axis()), whole(step->lateral_axis()), whole(2));
    }
    return at;
}

void warn_of_zeros(const std::vector<double>& zero_share, const Context& context) {
    const auto idle = std::count(zero_share.begin(), zero_share.end(), 1.0);
    if (idle > 0)
        context.warn(
            fmt::format("{} of {} seams meet{} no energy at all, so that carving them may change nothing visible; `mask.weight` gives empty space an energy of "
                        "its own, and `window: [first, last]` holds seams where the content is",
                        idle, zero_share.size(), idle == 1 ? "s" : ""));
}

}  // namespace

void SeamNode::check(const Params& params, NodeCheck& check) {
    for (const auto& [name, window] : {std::pair("window", params.window), std::pair("pair_window", params.pair_window)})
        if (window && (std::floor(window->low) != window->low || std::floor(window->high) != window->high))
            check.fault(name, fmt::format("parameter '{}' wants whole vertices, not {}", name, text(*window)));
    if (params.pair_window && !params.window) check.fault("pair_window", "parameter 'pair_window' wants a 'window' beside it, below it on the axis");
    if (params.pair_window && params.window && params.pair_window->low <= params.window->high)
        check.fault("pair_window",
                    fmt::format("pair_window {} {} window {}; it wants to begin above vertex {:g}", text(*params.pair_window),
                                params.pair_window->high < params.window->low ? "lies below" : "overlaps", text(*params.window), params.window->high));
    if (params.pair_still && !params.pair_window) check.fault("pair_static", "parameter 'pair_static' wants a 'pair_window'");
    const bool forward = params.cost == Cost::forward, field = check.connections("field") > 0;
    if (forward && !field) check.fault("cost", "cost 'forward' wants a `field`, in which it counts the edges that seams leave behind");
    if (!forward && field) check.fault("field", "input 'field' serves `cost: forward`, which is not asked for");
    if (!forward && check.stated("field_weight")) check.fault("field_weight", "parameter 'field_weight' serves `cost: forward`, which is not asked for");
    if (forward && params.pair_window && params.window && params.pair_window->low == params.window->high + 1)
        check.fault("pair_window",
                    "cost 'forward' wants a vertex between window and pair_window, since a seam at the end of one changes the edges of the other");
    if (forward && (params.still || params.pair_still))
        check.fault(params.still ? "static" : "pair_static", "cost 'forward' is counted frame by frame and finds no static seams; leave one of the two out");
}

SeamNode::Task SeamNode::task_of(const Params& params, const Ports& io, const Lattice& lattice) {
    Task out;
    out.shape = io.after.empty() ? lattice.shape : io.after.back()->shape_after(io.after.back()->seams.size());
    if (*std::min_element(out.shape.begin(), out.shape.end()) < 1)
        throw Failure(fmt::format("the seams of `after` leave nothing to carve: {} vertices", fmt::join(out.shape, " x ")));
    const int size = out.shape[static_cast<std::size_t>(params.axis)], count = params.count.of(size);
    out.kind = count > 0 ? Seams::Kind::insert : Seams::Kind::remove;
    out.count = std::abs(count);
    out.window = window_of("window", params.window, size, params.axis, !io.after.empty());
    require_room(out.kind, out.count, out.window, size);
    if (params.pair_window) {
        out.pair_window = window_of("pair_window", params.pair_window, size, params.axis, !io.after.empty());
        require_room(opposite(out.kind), out.count, *out.pair_window, size);
    }
    return out;
}

void SeamNode::add(const Params& params, const Ports& io, Context& context) {
    const auto& lattice = *io.lattice;
    lattices_.push_back(io.lattice);
    if (const auto& first = *lattices_.front(); lattice.shape != first.shape)
        throw Failure(
            fmt::format("the lattice has {} vertices here, but {} in the first frame", fmt::join(lattice.shape, " x "), fmt::join(first.shape, " x ")));
    // What does not fit is better told before the frames are read than after.
    const CarveMap before(lattice, io.after, context.frame(), std::nullopt);
    const auto task = task_of(params, io, lattice);
    if (!task.pair_window) {
        const int grown = task.shape[static_cast<std::size_t>(params.axis)] + (task.kind == Seams::Kind::insert ? task.count : -task.count);
        extension_.add(lattice, params.axis, std::max(0, grown - lattice.shape[static_cast<std::size_t>(params.axis)]), context.frame());
    }
    transform_.require("the energy", *io.energy, context.frame());
    if (io.field) {
        field_transform_.require("the field", *io.field, context.frame());
        field_met_ = field_met_ || meets_active_voxels(*io.field, lattice);
    }
    if (task.count == 0) return;
    if (!energy_) {
        const bool forward = params.cost == Cost::forward;
        energy_.emplace(task.shape, params.axis, context.frames().size(), context.memory_budget() / (forward ? 3 : 1), context.work_folder(), lattice.closed);
        energy_->set_rigidity({params.rigidity, params.rigidity_time});
        if (forward) energy_->add_field(params.field_weight, context.memory_budget() / 3, context.work_folder());
    }
    if (const auto box = io.energy->evalActiveVoxelBoundingBox(); !box.empty()) {
        any_active_ = true;
        any_met_ = any_met_ || meets_active_voxels(*io.energy, lattice);
        active_box_.expand(io.energy->transform().indexToWorld(openvdb::BBoxd(box.min().asVec3d(), box.max().asVec3d())));
    }
    if (io.after.empty()) {
        sample(params, io, lattice, energy_->slab(context.place()));
        if (io.field) sample_field(*io.field, lattice, params.axis, energy_->field(context.place()));
    } else {
        sampled_.resize(vertices(lattice.shape));
        sample(params, io, lattice, sampled_);
        if (io.field) {
            sampled_field_.resize(sampled_.size());
            sample_field(*io.field, lattice, params.axis, sampled_field_);
        }
        fill_slabs(before.steps(), params.axis, context.place());
    }
}

void SeamNode::sample(const Params& params, const Ports& io, const Lattice& lattice, std::span<std::uint16_t> slab) {
    sample_energy(*io.energy, lattice, params.axis, slab, params.measure);
    if (io.attract) attracted_ = attracted_.value_or(0) + mark_vertices(*io.attract->grid, lattice, params.axis, attracted_code, slab);
    if (io.protect) protected_ = protected_.value_or(0) + mark_vertices(*io.protect->grid, lattice, params.axis, protected_code, slab);
}

void SeamNode::fill_slabs(std::span<const CarveStep> before, Axis axis, std::size_t t) {
    const auto& shape = lattices_.front()->shape;
    std::ranges::copy(carve_energy(sampled_, shape, axis, before), energy_->slab(t).begin());
    if (energy_->has_field()) std::ranges::copy(carve_field(sampled_field_, shape, axis, before), energy_->field(t).begin());
}

Seams SeamNode::empty_seams(const Params& params, const Task& task, const Context& context) const {
    Seams out;
    out.axis = params.axis;
    out.kind = task.kind;
    out.closed = lattices_.front()->closed;
    out.shape = task.shape;
    out.frames = context.frames();
    out.lattice = lattices_.front()->description;
    std::vector<std::string> hashes;
    for (const auto& lattice : lattices_) hashes.push_back(lattice->hash);
    const bool same = std::all_of(hashes.begin(), hashes.end(), [&](const auto& hash) { return hash == hashes.front(); });
    out.lattice_hash = same ? hashes.front() : fmt::format("{}", fmt::join(hashes, ","));
    return out;
}

std::string SeamNode::why_no_more(const NoSeam& none, const Params& params, const Task& task, const Ports& io, const Context& context,
                                  bool in_pair_window) const {
    const auto lateral_axis = params.axis == Axis::u ? 1u : 0u;
    const int laterals = task.shape[lateral_axis];
    const auto per_frame = static_cast<std::size_t>(laterals) * static_cast<std::size_t>(task.shape[2]);
    const auto t = none.at.column / per_frame;
    const int c = static_cast<int>(none.at.column % per_frame), lateral = c % laterals, k = c / laterals;
    const auto& window = in_pair_window ? *task.pair_window : task.window;
    const bool still = in_pair_window ? params.pair_still : params.still;
    const auto& lattice = *lattices_[std::min(t, lattices_.size() - 1)];
    const CarveMap before(lattice, io.after, context.frames()[t], std::nullopt);
    const auto world = [&](int entry) {
        const auto vertex = vertex_of(params.axis, entry, lateral, k);
        const auto at = lattice.position(original_vertex(before.steps(), openvdb::Vec3d(vertex[0], vertex[1], vertex[2])));
        return fmt::format("({:g}, {:g}, {:g})", at.x(), at.y(), at.z());
    };
    const int last = window.first + none.found + none.at.vertices - 1;
    const auto span = fmt::format("{} to {}", window.first, last);
    const auto column = fmt::format("column ({}, {}, {}), from {} to {},", params.axis == Axis::u ? span : std::to_string(lateral),
                                    params.axis == Axis::u ? std::to_string(lateral) : span, k, world(window.first), world(last));
    return fmt::format("{} possible in {} [{}, {}]: {} {}; ask for fewer, widen the window or protect less",
                       none.found == 0 ? "no seam is" : fmt::format("{} of {} seams {}", none.found, task.count, none.found == 1 ? "is" : "are"),
                       in_pair_window ? "pair_window" : "window", window.first, window.last,
                       still ? "over all frames" : fmt::format("in frame {}", context.frames()[t]),
                       none.at.free == 0 ? fmt::format("{} has no unprotected vertex left", column)
                                         : fmt::format("of the {} vertices left in {} {} {} unprotected, but out of reach from the columns beside",
                                                       none.at.vertices, column, none.at.free, none.at.free == 1 ? "is" : "are"));
}

void SeamNode::warn_of_masks(Seams::Kind kind, const FoundSeams& found, const Context& context) const {
    for (const auto& [name, vertices] : {std::pair("protect", protected_), std::pair("attract", attracted_)})
        if (vertices == std::size_t{0}) context.warn(fmt::format("`{}` is set around no vertex of the lattice: nothing is {}ed", name, name));
    const auto idle = std::ranges::count(found.attracted, std::size_t{0});
    if (kind == Seams::Kind::remove && idle > 0 && found.attracted_left > 0)
        context.warn(
            fmt::format("{} of {} seams take nothing of `attract`, though some of it is left: it is out of their window, or the way there too long; "
                        "seam.greedy sees only what is beside its way, other solvers all",
                        idle, found.attracted.size()));
}

void SeamNode::find_all(const Params& params, const Task& task, const Ports& io, const Context& context, const FindSeam& find, Seams& out,
                        nlohmann::ordered_json& report) {
    // Energies and seams share the budget; what does not fit with the energies goes beside them on disk.
    const auto columns = out.columns_per_frame() * out.frames.size();
    const auto seam_bytes = static_cast<std::uint64_t>(task.count) * (task.pair_window ? 2 : 1) * columns * sizeof(std::uint16_t);
    const auto energy_bytes = static_cast<std::uint64_t>(columns) * energy_->stride() * sizeof(std::uint16_t) * (energy_->has_field() ? 3 : 1);
    KeepSeam keep;
    if (energy_bytes + seam_bytes > context.memory_budget())
        keep = [&](const SeamEntries& entries) { return SeamEntries::in_file(entries, context.work_folder()); };
    double done = 0;
    const auto search = [&](Seams::Kind kind, bool in_pair_window) {
        const double share = task.pair_window ? 0.5 : 1;
        const auto tick = [&](double fraction) {
            context.check_cancelled();
            context.progress(done + share * fraction);
        };
        const auto find_bounded = [&](const EnergyVolume& energy, Window now, int number, const Tick& tell) {
            auto seam = find(energy, now, number, tell);
            const bool few = seam.at.size() * static_cast<std::size_t>(now.size()) <= most_entries_bounded;
            if (!seam.lower_bound && (params.bound_passes || few))
                seam.lower_bound = energy_bound(energy, seam.at, lower_bound(energy, now, params.bound_passes.value_or(0), tell));
            return seam;
        };
        try {
            auto found = find_seams(*energy_, kind, task.count, in_pair_window ? *task.pair_window : task.window, find_bounded, tick, keep,
                                    in_pair_window ? params.pair_still : params.still);
            done += share;
            return found;
        } catch (const NoSeam& none) {
            throw Failure(why_no_more(none, params, task, io, context, in_pair_window));
        }
    };
    const auto energies = [](const std::vector<Seams::Seam>& seams) {
        auto list = nlohmann::ordered_json::array();
        for (const auto& seam : seams) list.push_back(seam.energy);
        return list;
    };

    const auto bounds = [](const std::vector<Seams::Seam>& seams) {
        auto list = nlohmann::ordered_json::array();
        for (const auto& seam : seams) list.push_back(seam.lower_bound ? nlohmann::ordered_json(*seam.lower_bound) : nullptr);
        return list;
    };
    const auto gaps = [](const std::vector<Seams::Seam>& seams) {
        auto list = nlohmann::ordered_json::array();
        for (const auto& seam : seams) {
            const bool known = seam.lower_bound && *seam.lower_bound > 0;
            list.push_back(known ? nlohmann::ordered_json(std::max(seam.energy / *seam.lower_bound - 1, 0.0)) : nullptr);
        }
        return list;
    };

    // The pair window first: what is taken there moves nothing in the window below.
    FoundSeams pairs;
    if (task.pair_window) pairs = search(opposite(task.kind), true);
    auto found = search(task.kind, false);
    for (std::size_t n = 0; n < pairs.wall_s.size(); ++n) found.wall_s[n] += pairs.wall_s[n];
    out.seams = std::move(found.seams);
    out.pairs = std::move(pairs.seams);
    report["energy"] = energies(out.seams);
    report["lower_bound"] = bounds(out.seams);
    report["gap"] = gaps(out.seams);
    if (task.pair_window) {
        report["pair_energy"] = energies(out.pairs);
        report["pair_lower_bound"] = bounds(out.pairs);
    }
    for (const auto& [name, mask, member] :
         {std::tuple("attracted", attracted_, &FoundSeams::attracted), std::tuple("protected", protected_, &FoundSeams::blocked)})
        if (mask) {
            report[name] = found.*member;
            if (task.pair_window) report[fmt::format("pair_{}", name)] = pairs.*member;
        }
    report["zero_share"] = found.zero_share;
    report["wall_s"] = found.wall_s;
    warn_of_zeros(found.zero_share, context);
    warn_of_masks(task.kind, found, context);
}

void SeamNode::solve(const Params& params, Ports& io, Context& context, const FindSeam& find) {
    const auto task = task_of(params, io, *lattices_.front());
    auto out = std::make_shared<Seams>(empty_seams(params, task, context));
    nlohmann::ordered_json report{{"axis", to_text(out->axis)},
                                  {"kind", to_text(out->kind)},
                                  {"shape", {task.shape[0], task.shape[1], task.shape[2], out->frames.size()}},
                                  {"energy", nlohmann::json::array()},
                                  {"zero_share", nlohmann::json::array()},
                                  {"wall_s", nlohmann::json::array()}};
    if (energy_) {
        if (any_active_ && !any_met_)
            throw Failure(
                fmt::format("the lattice misses the energy: its {}, but the active voxels span {}", lattices_.front()->description, text(active_box_)));
        // An energy that is the same for all frames comes once.
        for (auto t = lattices_.size(); t < out->frames.size(); ++t) {
            if (!io.after.empty()) {
                fill_slabs(CarveMap(*lattices_.front(), io.after, out->frames[t], std::nullopt).steps(), params.axis, t);
                continue;
            }
            std::ranges::copy(energy_->slab(0), energy_->slab(t).begin());
            if (energy_->has_field()) std::ranges::copy(energy_->field(0), energy_->field(t).begin());
        }
        if (energy_->has_field() && !field_met_)
            context.warn("the lattice misses the active voxels of `field` in all frames: without edges there, forward costs are those of the energy alone");
        if (energy_->has_field()) energy_->count_edges(context.memory_budget() / 3, context.work_folder());
        if (protected_ || attracted_) energy_->find_marks();
        find_all(params, task, io, context, find, *out, report);
        energy_.reset();
    }
    if (const auto fault = extension_.fault(); !fault.empty()) context.warn(fault);
    context.report("seams", report);
    io.seams = std::move(out);
}

}  // namespace fluidcarve
