#include "nodes/seam/seam_node.h"

#include "nodes/seam/energy/carve.h"
#include "nodes/seam/energy/column_places.h"
#include "nodes/seam/energy/marks.h"
#include "nodes/seam/search/bound.h"
#include "nodes/seam/search/strip.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace fluidcarve {

namespace {

/// Up to this many energies, a bound takes no longer than a search.
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

/// Lattice coordinates of a vertex of the space that earlier seams leave. An inserted vertex stands halfway between two.
openvdb::Vec3d original_vertex(const std::vector<CarveStep>& steps, openvdb::Vec3d at) {
    for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
        const auto whole = [&](int axis) { return static_cast<int>(std::floor(at[axis])); };
        const int entry = whole(step->axis()) + step->start();
        at[step->axis()] += step->start() - step->origin() + 0.5 * step->displacement(entry, step->first_lateral() + whole(step->lateral_axis()), whole(2));
    }
    return at;
}

nlohmann::ordered_json empty_report(const Seams& seams) {
    return {{"axis", to_text(seams.axis)},
            {"kind", to_text(seams.kind)},
            {"shape", {seams.shape[0], seams.shape[1], seams.shape[2], seams.frames.size()}},
            {"energy", nlohmann::json::array()},
            {"zero_share", nlohmann::json::array()},
            {"wall_s", nlohmann::json::array()}};
}

/// Bytes of the memory budget for the energies. The field, and the energies without its edges, take as much each.
std::uint64_t energy_budget(bool forward, const Context& context) { return context.memory_budget() / (forward ? 3 : 1); }

/// Shortens the lists of a report to the first `count` seams.
void cut_lists(nlohmann::ordered_json& report, std::size_t count) {
    for (auto& [name, list] : report.items())
        if (name != "shape" && list.is_array() && list.size() > count) list.erase(list.begin() + static_cast<std::ptrdiff_t>(count), list.end());
}

}  // namespace

Shape ParamTraits<Anchor>::shape() { return {Shape::Kind::any_of, {}, {{Shape::Kind::choice, {"low", "middle", "high"}, {}}, {Shape::Kind::integer, {}, {}}}}; }

std::optional<Anchor> ParamTraits<Anchor>::parse(const Value& value, ValueReader& reader) {
    for (const auto at : {Anchor::At::low, Anchor::At::middle, Anchor::At::high})
        if (value.kind == Value::Kind::scalar && value.text == text({at, 0})) return Anchor{at, 0};
    if (const auto vertex = reader.number(value, true)) return Anchor{Anchor::At::vertex, static_cast<int>(*vertex)};
    return std::nullopt;
}

std::string ParamTraits<Anchor>::text(const Anchor& anchor) { return to_text(anchor); }

void SeamNode::check(const Params& params, NodeCheck& check) {
    if (params.anchor.vertex < 0)
        check.fault("anchor", fmt::format("parameter 'anchor' wants low, middle, high or a vertex from 0 on, not {}", params.anchor.vertex));
    if (params.pair_window && check.stated("anchor")) check.fault("anchor", "pairs of seams move neither end of the lattice: leave 'anchor' out");
    for (const auto& [name, window] : {std::pair("window", params.window), std::pair("pair_window", params.pair_window)})
        if (window && (std::floor(window->low) != window->low || std::floor(window->high) != window->high))
            check.fault(name, fmt::format("parameter '{}' wants whole vertices, not {}", name, text(*window)));
    if (params.pair_window && !params.window) check.fault("pair_window", "parameter 'pair_window' wants a 'window' beside it, below it on the axis");
    if (params.pair_window && params.window && params.pair_window->low <= params.window->high)
        check.fault("pair_window",
                    fmt::format("pair_window {} {} window {}; it wants to begin above vertex {:g}", text(*params.pair_window),
                                params.pair_window->high < params.window->low ? "lies below" : "overlaps", text(*params.window), params.window->high));
    if (params.pair_static && !params.pair_window) check.fault("pair_static", "parameter 'pair_static' wants a 'pair_window'");
    const bool field = check.connections("field") > 0, forward = params.cost.value_or(field ? Cost::forward : Cost::backward) == Cost::forward;
    if (forward && !field) check.fault("cost", "cost 'forward' wants a `field`, in which it counts the edges that seams leave behind");
    if (!forward && field) check.fault("field", "input 'field' serves `cost: forward`, but `cost` is backward: leave one of the two out");
    for (const auto* const name : {"field_weight", "empty"})
        if (!forward && check.stated(name)) check.fault(name, fmt::format("parameter '{}' wants a `field`, in which content and edges are seen", name));
    if (forward && params.pair_window && params.window && params.pair_window->low == params.window->high + 1)
        check.fault("pair_window",
                    "with a `field` there must be a vertex between window and pair_window, since a seam at the end of one changes the edges of the other");
    if (forward && (params.static_ || params.pair_static))
        check.fault(params.static_ ? "static" : "pair_static",
                    "with a `field` costs are counted frame by frame, and no static seams are found; leave one of the two out");
}

SeamNode::Task SeamNode::task_of(const Params& params, const Ports& io, const Lattice& lattice) {
    Task out;
    out.shape = io.after.empty() ? lattice.shape : io.after.back()->shape_after(io.after.back()->seams.size());
    if (*std::min_element(out.shape.begin(), out.shape.end()) < 1)
        throw Failure(fmt::format("the seams of `after` leave nothing to carve: {} vertices", fmt::join(out.shape, " x ")));
    const int size = out.shape[static_cast<std::size_t>(params.axis)], count = params.count.of(size);
    out.kind = kind_asked(count);
    out.count = std::abs(count);
    out.window = window_of("window", params.window, size, params.axis, !io.after.empty());
    require_room(out.kind, out.count, out.window, size);
    if (params.anchor.vertex > size - 1)
        throw Failure(fmt::format("anchor {} lies beyond the lattice, which has {} vertices along {}{}: 0 to {}", params.anchor.vertex, size,
                                  to_text(params.axis), io.after.empty() ? "" : " once the seams of `after` are carved", size - 1));
    if (params.pair_window) {
        out.pair_window = window_of("pair_window", params.pair_window, size, params.axis, !io.after.empty());
        require_room(opposite(out.kind), out.count, *out.pair_window, size);
    }
    return out;
}

std::shared_ptr<FrameEnergy> SeamNode::digest(const Params& params, const Ports& io, Context&) {
    const auto& lattice = *io.lattice;
    auto out = std::make_shared<FrameEnergy>();
    out->lattice = io.lattice;
    out->energy.resize(vertices(lattice.shape));
    sample_energy(*io.energy, lattice, params.axis, out->energy, params.measure);
    if (io.attract) out->attract = mark_vertices(*io.attract->grid, lattice, params.axis, attracted_code, out->energy);
    if (io.protect) out->protect = mark_vertices(*io.protect->grid, lattice, params.axis, protected_code, out->energy);
    out->transform = io.energy->transform().copy();
    if (const auto box = io.energy->evalActiveVoxelBoundingBox(); !box.empty()) {
        out->active = io.energy->transform().indexToWorld(openvdb::BBoxd(box.min().asVec3d(), box.max().asVec3d()));
        out->met = meets_active_voxels(*io.energy, lattice);
    }
    if (io.field) {
        out->field.resize(out->energy.size());
        sample_field(*io.field, lattice, params.axis, out->field);
        out->field_transform = io.field->transform().copy();
    }
    return out;
}

void SeamNode::add(const Params& params, const Ref<FrameEnergy>& frame, Context& context) {
    // Most frames share one lattice.
    const bool same = !lattices_.empty() && lattices_.back()->hash == frame->lattice->hash;
    lattices_.push_back(same ? lattices_.back() : frame->lattice);
    const auto &lattice = *lattices_.back(), &first = *lattices_.front();
    if (lattice.shape != first.shape)
        throw Failure(
            fmt::format("the lattice has {} vertices here, but {} in the first frame", fmt::join(lattice.shape, " x "), fmt::join(first.shape, " x ")));
    transform_.require("the energy", *frame->transform, context.frame());
    if (frame->field_transform) field_transform_.require("the field", *frame->field_transform, context.frame());
    if (params.count.value == 0) return;
    any_met_ = any_met_ || frame->met;
    if (frame->active) {
        any_active_ = true;
        active_box_.expand(*frame->active);
    }
    if (frame->attract) attracted_ = attracted_.value_or(0) + *frame->attract;
    if (frame->protect) protected_ = protected_.value_or(0) + *frame->protect;
    forward_ = !frame->field.empty();
    if (!energy_) make_room(lattice.shape, params, context, energy_budget(forward_, context));
    std::ranges::copy(frame->energy, energy_->slab(context.place()).begin());
    if (energy_->has_field()) std::ranges::copy(frame->field, energy_->field(context.place()).begin());
}

void SeamNode::make_room(const std::array<int, 3>& shape, const Params& params, const Context& context, std::uint64_t budget) {
    energy_.emplace(shape, params.axis, context.frames().size(), budget, context.work_folder(), lattices_.front()->closed);
    energy_->set_spread(params.spread.value_or(forward_ ? 3 : 0));
    if (forward_) energy_->add_field(0, budget, context.work_folder());
}

void SeamNode::fill_frames(const Params& params, const Task& task, const Ports& io, const Context& context) {
    const auto& frames = context.frames();
    // A static energy was added only once.
    const auto place_of = [&](std::size_t t) { return std::min(t, lattices_.size() - 1); };
    // Typical values of the whole lattice also hold for the space that earlier seams leave.
    const auto prices = [&](const EnergyVolume& whole, EnergyVolume& to) {
        const float rigid = forward_ ? default_rigidity : 0.0f;
        set_prices(to, Typical::of(whole), {params.field_weight, params.empty, {params.rigidity.value_or(rigid), params.rigidity_time.value_or(rigid)}});
    };
    if (io.after.empty()) {
        for (auto t = lattices_.size(); t < frames.size(); ++t) {
            std::ranges::copy(energy_->slab(0), energy_->slab(t).begin());
            if (energy_->has_field()) std::ranges::copy(energy_->field(0), energy_->field(t).begin());
        }
        return prices(*energy_, *energy_);
    }
    auto whole = std::move(*energy_);
    const auto& shape = lattices_.front()->shape;
    const auto held = vertices(shape) * frames.size() * sizeof(std::uint16_t), budget = energy_budget(forward_, context);
    make_room(task.shape, params, context, held > budget ? budget : budget - held);
    for (std::size_t t = 0; t < frames.size(); ++t) {
        const auto place = place_of(t);
        const CarveMap before(*lattices_[place], io.after, frames[t], std::nullopt);
        const auto copy = [](std::span<const std::uint16_t> slab) { return std::vector<std::uint16_t>(slab.begin(), slab.end()); };
        std::ranges::copy(carve_energy(copy(whole.slab(place)), shape, params.axis, before.steps()), energy_->slab(t).begin());
        if (whole.has_field()) std::ranges::copy(carve_field(copy(whole.field(place)), shape, params.axis, before.steps()), energy_->field(t).begin());
    }
    prices(whole, *energy_);
}

std::string SeamNode::extension_fault(const Seams& found, const Ports& io, const Context& context) const {
    if (found.paired()) return {};
    const auto axis = static_cast<std::size_t>(found.axis);
    int first = found.shift_after(found.seams.size());
    for (const auto& set : io.after)
        if (set->axis == found.axis) first += set->shift_after(set->seams.size());
    const int end = first + found.shape_after(found.seams.size())[axis];
    Extension extension;
    for (std::size_t t = 0; t < lattices_.size(); ++t)
        extension.add(*lattices_[t], found.axis, std::max(0, -first), std::max(0, end - lattices_[t]->shape[axis]), context.frames()[t]);
    return extension.fault();
}

void SeamNode::resume(const Payload& result, const nlohmann::ordered_json& entry) {
    before_ = result.as<Seams>();
    reported_ = entry;
}

Extent SeamNode::extent(const Payload& result) {
    const auto seams = result.as<Seams>();
    return {seams->seams.size(), static_cast<std::size_t>(seams->carved())};
}

std::size_t SeamNode::wanted(const Params& params, std::size_t vertices) {
    return static_cast<std::size_t>(std::abs(params.count.of(static_cast<int>(vertices))));
}

Payload SeamNode::first(const Payload& result, std::size_t count, nlohmann::ordered_json& entry) {
    auto out = std::make_shared<Seams>(*result.as<Seams>());
    for (auto* const seams : {&out->seams, &out->pairs})
        if (seams->size() > count) seams->erase(seams->begin() + static_cast<std::ptrdiff_t>(count), seams->end());
    cut_lists(entry, count);
    if (count == 0) {
        out->kind = Seams::Kind::remove;
        entry = empty_report(*out);
    }
    return Payload(std::move(out));
}

std::vector<std::string> SeamNode::warnings(const nlohmann::ordered_json& entry) {
    std::vector<std::string> out;
    const auto& zero_share = entry.at("zero_share");
    if (const auto idle = std::count(zero_share.begin(), zero_share.end(), 1.0); idle > 0)
        out.push_back(
            fmt::format("{} of {} seams meet{} no energy at all, so that carving them may change nothing visible; `mask.weight` gives empty space an energy of "
                        "its own, and `window: [first, last]` holds seams where the content is",
                        idle, zero_share.size(), idle == 1 ? "s" : ""));
    if (!entry.contains("attracted")) return out;
    const auto& attracted = entry.at("attracted");
    if (const auto idle = std::count(attracted.begin(), attracted.end(), 0); idle > 0 && entry.at("kind") == "remove" && entry.at("attracted_left").back() > 0)
        out.push_back(
            fmt::format("{} of {} seams take nothing of `attract`, though some of it is left: it is out of their window, or the way there too long; "
                        "seam.greedy sees only what is beside its way, other solvers all",
                        idle, attracted.size()));
    return out;
}

Seams SeamNode::empty_seams(const Params& params, const Task& task, const Context& context) const {
    Seams out;
    out.axis = params.axis;
    out.kind = task.kind;
    out.closed = lattices_.front()->closed;
    out.shape = task.shape;
    out.frames = context.frames();
    out.lattice = lattices_.front()->description;
    if (params.window) out.window = task.window;
    if (params.pair_window) out.pair_window = task.pair_window;
    out.anchor = params.anchor;
    std::vector<std::string> hashes;
    for (const auto& lattice : lattices_) hashes.push_back(lattice->hash);
    const bool same = std::all_of(hashes.begin(), hashes.end(), [&](const auto& hash) { return hash == hashes.front(); });
    out.lattice_hash = same ? hashes.front() : fmt::format("{}", fmt::join(hashes, ","));
    return out;
}

std::string SeamNode::why_no_more(const NoSeam& none, const Params& params, const Task& task, const Ports& io, const Context& context,
                                  bool in_pair_window) const {
    const int laterals = task.shape[lateral_dimension(params.axis)];
    const auto per_frame = static_cast<std::size_t>(laterals) * static_cast<std::size_t>(task.shape[2]);
    const auto t = none.at.column / per_frame;
    const int c = static_cast<int>(none.at.column % per_frame), lateral = c % laterals, k = c / laterals;
    const auto& window = in_pair_window ? *task.pair_window : task.window;
    const bool static_ = in_pair_window ? params.pair_static : params.static_;
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
                       static_ ? "over all frames" : fmt::format("in frame {}", context.frames()[t]),
                       none.at.free == 0 ? fmt::format("{} has no unprotected vertex left", column)
                                         : fmt::format("of the {} vertices left in {} {} {} unprotected, but out of reach from the columns beside",
                                                       none.at.vertices, column, none.at.free, none.at.free == 1 ? "is" : "are"));
}

void SeamNode::describe(const FoundSeams& found, const std::string& prefix, nlohmann::ordered_json& report) const {
    auto energy = nlohmann::ordered_json::array(), bound = energy, gap = energy;
    for (const auto& seam : found.seams) {
        const auto& least = seam.lower_bound;
        energy.push_back(seam.energy);
        bound.push_back(least ? nlohmann::ordered_json(*least) : nullptr);
        gap.push_back(least && *least > 0 ? nlohmann::ordered_json(std::max(seam.energy / *least - 1, 0.0)) : nullptr);
    }
    report[prefix + "energy"] = std::move(energy);
    report[prefix + "lower_bound"] = std::move(bound);
    if (prefix.empty()) {
        report["gap"] = std::move(gap);
        report["zero_share"] = found.zero_share;
    }
    if (attracted_) {
        report[prefix + "attracted"] = found.attracted;
        if (prefix.empty()) report["attracted_left"] = found.attracted_left;
    }
    if (protected_) report[prefix + "protected"] = found.blocked;
}

std::vector<double> SeamNode::wall_s(const FoundSeams& pairs, const FoundSeams& found) const {
    std::vector<double> out;
    if (before_ && reported_.contains("wall_s")) reported_.at("wall_s").get_to(out);
    for (const auto* const list : {&pairs.wall_s, &found.wall_s}) {
        out.resize(std::max(out.size(), list->size()));
        for (std::size_t n = 0; n < list->size(); ++n) out[n] += (*list)[n];
    }
    return out;
}

void SeamNode::find_all(const Params& params, const Task& task, const Ports& io, const Context& context, const FindSeam& find, const StartFrom& start_from,
                        Seams& out, nlohmann::ordered_json& report) {
    // Energies and seams share the budget. Seams that do not fit beside the energies go to disk.
    const auto columns = out.columns_per_frame() * out.frames.size();
    const auto seam_bytes = static_cast<std::uint64_t>(task.count) * (task.pair_window ? 2 : 1) * columns * sizeof(std::uint16_t);
    const auto energy_bytes = static_cast<std::uint64_t>(columns) * energy_->stride() * sizeof(std::uint16_t) * (energy_->has_field() ? 3 : 1);
    const auto taken = energy_bytes + seam_bytes;
    KeepSeam keep;
    if (taken > context.memory_budget()) keep = [&](const SeamEntries& entries) { return SeamEntries::in_file(entries, context.work_folder()); };

    FoundSeams pairs, found;
    auto held = std::chrono::steady_clock::now();
    // Delivers the seams found so far as a complete set. Pairs are found first, so there may be more of them.
    const auto hold = [&](const FoundSeams& now, bool in_pair_window) {
        if (std::chrono::steady_clock::now() - held < hold_after_) return;
        auto part = out;
        auto said = report;
        if (in_pair_window) {
            if (before_) {
                part.seams = before_->seams;
                said = reported_;
            }
            part.pairs = now.seams;
            describe(now, "pair_", said);
            said["wall_s"] = wall_s(now, {});
        } else {
            part.seams = now.seams;
            part.pairs = pairs.seams;
            describe(now, "", said);
            if (task.pair_window) describe(pairs, "pair_", said);
            said["wall_s"] = wall_s(pairs, now);
            part.find_shifts();
        }
        context.report("seams", said);
        context.hold(Payload(std::make_shared<Seams>(std::move(part))));
        held = std::chrono::steady_clock::now();
    };
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
        Continued continued;
        if (before_) continued.before = in_pair_window ? before_->pairs : before_->seams;
        continued.start_from = start_from;
        continued.found = [&](const FoundSeams& now) {
            // After the last seam, the whole set is delivered anyway.
            if (in_pair_window || now.seams.size() < static_cast<std::size_t>(task.count)) hold(now, in_pair_window);
        };
        continued.memory_budget = taken > context.memory_budget() ? 0 : context.memory_budget() - taken;
        continued.folder = context.work_folder();
        try {
            auto seams = find_seams(*energy_, kind, task.count, in_pair_window ? *task.pair_window : task.window, find_bounded, tick, keep,
                                    in_pair_window ? params.pair_static : params.static_, continued);
            done += share;
            return seams;
        } catch (const NoSeam& none) {
            throw Failure(why_no_more(none, params, task, io, context, in_pair_window));
        }
    };

    // The pair window comes first: seams there do not move the window below.
    if (task.pair_window) pairs = search(opposite(task.kind), true);
    found = search(task.kind, false);
    describe(found, "", report);
    if (task.pair_window) describe(pairs, "pair_", report);
    report["wall_s"] = wall_s(pairs, found);
    out.seams = std::move(found.seams);
    out.pairs = std::move(pairs.seams);
    out.find_shifts();
}

void SeamNode::solve(const Params& params, Ports& io, Context& context, const FindSeam& find, const StartFrom& start_from) {
    const auto& lattice = *lattices_.front();
    // Fails if the sets of `after` do not fit together. This must come before task_of(), which asks for the space that they leave.
    const CarveMap before(lattice, io.after, context.frames().front(), std::nullopt);
    const auto task = task_of(params, io, lattice);
    auto out = std::make_shared<Seams>(empty_seams(params, task, context));
    auto report = empty_report(*out);
    if (task.count > 0) {
        if (any_active_ && !any_met_)
            throw Failure(fmt::format("the lattice misses the energy: its {}, but the active voxels span {}", lattice.description, text(active_box_)));
        fill_frames(params, task, io, context);
        if (energy_->has_field()) energy_->count_edges(context.memory_budget() / 3, context.work_folder());
        if (protected_ || attracted_) energy_->find_marks();
        // An unfinished larger set may hold more pairs than are wanted.
        if (before_) before_ = first(Payload(before_), static_cast<std::size_t>(task.count), reported_).as<Seams>();
        find_all(params, task, io, context, find, start_from, *out, report);
        energy_.reset();
        for (const auto& [name, marked] : {std::pair("protect", protected_), std::pair("attract", attracted_)})
            if (marked == std::size_t{0}) context.warn(fmt::format("`{}` is set around no vertex of the lattice: nothing is {}ed", name, name));
        for (const auto& warning : warnings(report)) context.warn(warning);
    }
    if (const auto fault = extension_fault(*out, io, context); !fault.empty()) context.warn(fault);
    context.report("seams", report);
    io.seams = std::move(out);
}

}  // namespace fluidcarve
