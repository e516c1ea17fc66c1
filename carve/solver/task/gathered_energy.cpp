#include "carve/solver/task/gathered_energy.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"
#include "carve/field/active_range.h"
#include "carve/simd/wide.h"
#include "carve/solver/costs/carve.h"
#include "carve/solver/costs/eddies.h"
#include "carve/solver/costs/half.h"
#include "carve/solver/costs/turned.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <span>
#include <string>
#include <utility>

namespace fluidcarve {

namespace {

/// With a field; in mean energies of content, of thick seams in mean prices.
constexpr float default_rigidity = 0.2f;
constexpr float rigidity_of_frames = 2;  ///< of thin seams of frames
/// Eddies side by side, from which on seams are thick by default.
constexpr double least_across = 1.2;
constexpr float thin_empty = 0.9f;  ///< default of `empty`
/// Share of the content in the lattice below which the lattice is probably misplaced.
constexpr double small_share = 0.05;
constexpr double least_share = 1e-4;  ///< below this share, messages state no number

/// The prices of steps, in mean energies. Seams of frames have steps in space alone.
std::array<float, 2> rigidity_of(const SolverParams& params, float fallback) {
    const float in_space = params.rigidity.value_or(fallback);
    return {in_space, params.axis == Axis::t ? in_space : params.rigidity_time.value_or(fallback)};
}

Prices prices_of(const SolverParams& params, bool forward) {
    // Neighbouring places should change at the same moment.
    const float rigid = !forward                 ? 0.0f
                        : params.axis == Axis::t ? rigidity_of_frames
                                                 : default_rigidity;
    return {params.field_weight, params.empty.value_or(thin_empty), rigidity_of(params, rigid),
            params.axis == Axis::t};
}

/// Joins the MissedRange of earlier frames with that of another frame. If the mask is not empty
/// there, that is no longer why it marks nothing.
void join(std::optional<MissedRange>& all, const std::optional<MissedRange>& frame) {
    if (all && frame) all->values = joined(all->values, frame->values);
    else all.reset();
}

/// Expands a range of energy codes by others, marks left out.
FLUIDCARVE_WIDE void expand(std::uint16_t& lowest, std::uint16_t& highest,
                            std::span<const std::uint16_t> codes) {
    // For the lowest code, marks count as above all energies.
    auto low = lowest, high = highest;
    for (const auto code : codes) {
        const auto energy = code < protected_code ? code : std::uint16_t{0};
        low = low < code ? low : code;
        high = high > energy ? high : energy;
    }
    lowest = low;
    highest = high;
}

std::string box_text(const openvdb::BBoxd& box) {
    return fmt::format("({}) to ({})", numbers_text(box.min()), numbers_text(box.max()));
}

}  // namespace

void GatheredEnergy::add(const SolverParams& params, const FrameEnergy& frame, const FramePlace& at,
                         const Limits& limits) {
    // Most frames share one lattice.
    const bool same = !lattices_.empty() && lattices_.back()->hash == frame.lattice->hash;
    lattices_.push_back(same ? lattices_.back() : frame.lattice);
    const auto &lattice = *lattices_.back(), &first = *lattices_.front();
    if (lattice.shape != first.shape)
        throw Failure(fmt::format("the lattice has {} vertices here, but {} in the first frame",
                                  fmt::join(lattice.shape, " x "), fmt::join(first.shape, " x ")));
    if (params.axis == Axis::t && lattice.hash != first.hash)
        throw Failure(
            "the lattice is another one than in the first frame, but seams of frames need one that "
            "stands still: use lattice.box, or a rig that does not move");
    transform_.require("the energy", *frame.transform, at.number);
    if (frame.field_transform)
        field_transform_.require("the field", *frame.field_transform, at.number);
    if (params.count.value == 0) return;
    content_.add(frame.content);
    if (frame.active) active_box_.expand(*frame.active);
    expand(lowest_, highest_, frame.energy);
    if (frame.attract) marks_.attract = marks_.attract.value_or(0) + *frame.attract;
    if (frame.protect) marks_.protect = marks_.protect.value_or(0) + *frame.protect;
    if (lattices_.size() == 1) {
        marks_.protect_missed = frame.protect_missed;
        marks_.attract_missed = frame.attract_missed;
    }
    join(marks_.protect_missed, frame.protect_missed);
    join(marks_.attract_missed, frame.attract_missed);
    has_field_ = !frame.field.empty();
    finest_ = frame.finest;
    if (!energy_) energy_.emplace(room(lattice.shape, at.frames, params, limits, budget(limits)));
    gather(frame, at.place / static_cast<std::size_t>(finest_));
}

void GatheredEnergy::gather(const FrameEnergy& frame, std::size_t place) {
    begun_.resize(energy_->frames());
    const bool first = !begun_[place];
    begun_[place] = true;
    if (first) {
        std::ranges::copy(frame.energy, energy_->codes(place).begin());
        if (has_field_) energy_->set_field(place, frame.field);
        return;
    }
    average_energy(frame.energy, energy_->codes(place));
    if (!has_field_) return;
    auto field = energy_->field_codes(place);
    average_field(frame.field, field);
    energy_->set_field(place, field);
}

void GatheredEnergy::require_met() const {
    if (content_.voxels > 0 && content_.inside == 0)
        throw Failure(
            fmt::format("the lattice misses the energy: its {}, but the active voxels span {}; "
                        "move the lattice (its rig, or `min` and `max`) or the data (`translate` "
                        "and `scale` of its reader)",
                        lattices_.front()->description, box_text(active_box_)));
}

std::optional<double> GatheredEnergy::content_share() const {
    return content_.voxels > 0 ? std::optional(content_.share()) : std::nullopt;
}

std::vector<std::string> GatheredEnergy::warnings() const {
    auto out = mask_warnings(marks_);
    if (const auto share = content_share(); share && *share < small_share)
        out.push_back(
            fmt::format("{} of the active voxels of `energy` lie in the lattice, and nothing else "
                        "will change: if that is not meant, move the lattice (its rig, "
                        "or `min` and `max`) or make it larger",
                        *share < least_share ? fmt::format("less than {:g} %", 100 * least_share)
                                             : fmt::format("{:.2g} %", 100 * *share)));
    // With a field, seams pay for edges; with masks, they follow these.
    if (lowest_ == highest_ && !has_field_ && !marks_.protect && !marks_.attract)
        out.push_back(fmt::format(
            "`energy` is {:g} at all vertices of the lattice in all frames: a seam costs the same "
            "wherever it goes, and will go anywhere; connect an energy that is high where the look "
            "must stay, such as energy.gradient",
            decode_energy(lowest_)));
    return out;
}

EnergyVolume GatheredEnergy::room(const std::array<int, 3>& shape, std::size_t frames,
                                  const SolverParams& params, const Limits& limits,
                                  std::uint64_t budget) const {
    return EnergyVolume(
        {gathered_shape(shape, finest_), sampled_axis(params.axis),
         finest_ == 2 ? halved(frames) : frames,
         lattices_.front()->closed && params.axis != Axis::w, lattices_.front()->around},
        {budget, limits.folder});
}

GatheredEnergy::SampledEnergy GatheredEnergy::uncarved() {
    auto out = std::move(*energy_);
    const bool still = lattices_.size() == 1 && out.frames() > 1;
    const auto field = still && out.has_field() ? out.field_codes(0) : std::vector<std::uint16_t>();
    for (std::size_t t = 1; still && t < out.frames(); ++t) {
        std::ranges::copy(out.codes(0), out.codes(t).begin());
        if (out.has_field()) out.set_field(t, field);
    }
    const auto typical = Typical::of(out);
    return {std::move(out), typical};
}

std::uint64_t GatheredEnergy::left_beside(const EnergyVolume& other, const Limits& limits) const {
    const auto bytes =
        other.columns_per_frame() * other.stride() * other.frames() * sizeof(std::uint16_t);
    const auto all = budget(limits);
    return bytes > all ? all : all - bytes;
}

GatheredEnergy::SampledEnergy GatheredEnergy::carved(const SolverParams& params,
                                                     const CarvedSpace& space,
                                                     const Limits& limits) {
    auto from = std::move(*energy_);
    const auto& shape = lattices_.front()->shape;
    auto out =
        room(space.shape(), space.frames().size(), params, limits, left_beside(from, limits));
    for (std::size_t t = 0; t < out.frames(); ++t) {
        const auto first = t * static_cast<std::size_t>(finest_),
                   place = space.place(first) / static_cast<std::size_t>(finest_);
        const auto before = space.carve_map(first);
        const auto codes = from.codes(place);
        std::ranges::copy(
            carve_energy({codes.begin(), codes.end()}, shape, params.axis, before.steps(), finest_),
            out.codes(t).begin());
        if (from.has_field())
            out.set_field(t, carve_field(from.field_codes(place), shape, params.axis,
                                         before.steps(), finest_));
    }
    // Typical values of the whole lattice also hold for the space that earlier seams leave.
    return {std::move(out), Typical::of(from)};
}

GatheredEnergy::SampledEnergy GatheredEnergy::take_sampled(const SolverParams& params,
                                                           const CarvedSpace& space,
                                                           const Limits& limits) {
    auto out = space.carved() ? carved(params, space, limits) : uncarved();
    energy_.reset();
    if (params.axis != Axis::t) return out;
    auto in_time = turned(out.energy, {left_beside(out.energy, limits), limits.folder});
    const auto typical = Typical::of(in_time);
    return {std::move(in_time), typical};
}

std::optional<Thick> GatheredEnergy::thick_for(const SolverParams& params,
                                               const EnergyVolume& energy) const {
    if (!has_field_ || params.thickness == 1) return std::nullopt;
    const auto& shape = lattices_.front()->shape;
    const bool image = std::ranges::min(shape) == 1;
    const bool for_thin = params.static_ || params.pair_static || params.cost || params.spread;
    // Between protected vertices ways may be narrow, and an object may be narrower than a slab.
    const bool marked = marks_.protect.value_or(0) + marks_.attract.value_or(0) > 0;
    if (!params.thickness && (image || for_thin || marked)) return std::nullopt;
    int thickness = 0;
    if (params.thickness) {
        thickness = (*params.thickness + finest_ - 1) / finest_;
    } else {
        const auto eddies = Eddies::of(energy);
        // A single smooth thing would be doubled as a whole, instead of stretched.
        if (eddies.across < least_across) return std::nullopt;
        thickness = std::min(eddies.width, energy.width() / 4);
    }
    if (thickness * finest_ <= 1) return std::nullopt;
    return Thick{thickness,
                 {params.field_weight, params.empty, rigidity_of(params, default_rigidity)}};
}

GatheredEnergy::PricedEnergy GatheredEnergy::take_priced(const SolverParams& params,
                                                         const CarvedSpace& space,
                                                         const Limits& limits) {
    auto sampled = take_sampled(params, space, limits);
    PricedEnergy out{std::move(sampled.energy), std::nullopt, 1};
    out.thick = thick_for(params, out.energy);
    if (out.thick) {
        out.thickness = out.thick->thickness * finest_;
    } else {
        const int spread = params.spread.value_or(has_field_ ? 3 : 0);
        out.energy.set_spread(finest_ == 2 ? halved(spread) : spread, params.axis == Axis::t);
        add_prices(out.energy, sampled.typical, prices_of(params, has_field_),
                   {budget(limits), limits.folder});
    }
    if (marks_.protect || marks_.attract) out.energy.find_marks();
    return out;
}

}  // namespace fluidcarve
