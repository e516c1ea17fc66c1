#include "carve/solver/costs/energy_volume.h"

#include "carve/base/each_in_parallel.h"
#include "carve/solver/costs/decode.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace fluidcarve {

namespace {

using ColumnRange = tbb::blocked_range<std::size_t>;

/// An attracted vertex is worth a way through this many vertices of the highest energy.
constexpr float attraction_of_highest = 64;

/// Adds equal shares of what an entry hands on to the unmarked entries near it, unless it is marked
/// itself.
/// @param handed_on  of `entry`
template <class Unmarked, class EnergyAt, class HandedOn, class Set>
void share(int entry, Window near, const Unmarked& unmarked, const EnergyAt& energy_at,
           const HandedOn& handed_on, const Set& set) {
    if (!unmarked(entry)) return;
    int receivers = -1;
    for (int e = near.first; e <= near.last; ++e) receivers += unmarked(e) ? 1 : 0;
    if (receivers <= 0) return;
    const float part = handed_on(entry) / static_cast<float>(receivers);
    for (int e = near.first; e <= near.last; ++e)
        if (e != entry && unmarked(e)) set(e, energy_at(e) + part);
}

}  // namespace

EnergyVolume::EnergyVolume(const Shape& shape, const Limits& limits, std::vector<float> costs)
    : shape_{{shape.lattice[dimension(shape.axis)], shape.lattice[lateral_dimension(shape.axis)],
              shape.lattice[slice_dimension(shape.axis)]},
             Axis::u,
             shape.frames,
             shape.closed,
             shape.around},
      stride_(static_cast<std::size_t>(width())),
      limits_(limits),
      codes_(frames(), costs.empty() ? stride_ * columns_per_frame() : 0, limits),
      sums_(std::move(costs)),
      marks_{.protect = std::ranges::any_of(sums_, [](float cost) { return std::isinf(cost); })} {}

void EnergyVolume::set_field(std::size_t t, std::span<const std::uint16_t> codes) {
    if (!field_) field_.emplace(frames(), columns_per_frame(), width(), limits_);
    field_->set(t, codes);
}

std::vector<std::uint16_t> EnergyVolume::field_codes(std::size_t t) const {
    const auto columns = columns_per_frame();
    std::vector<std::uint16_t> out(columns * stride_);
    each_in_parallel(columns, 4096, [&](std::size_t c) {
        const auto& run = field(t * columns + c);
        std::copy_n(run.codes, run.end - run.first,
                    out.begin() + static_cast<std::ptrdiff_t>(c * stride_) + run.first);
    });
    return out;
}

std::uint64_t EnergyVolume::bytes() const {
    return codes_.count() * codes_.entries(0).size_bytes() + sums_.size() * sizeof(float) +
           (field_ ? field_->bytes() : 0);
}

void EnergyVolume::set_edges(std::size_t column, int first, int last) {
    // Entries at once.
    constexpr int most = 32;
    std::array<float, most> energies;
    std::array<float, most + 2> field;
    const auto& run = this->field(column);
    auto* const out = codes_of(column);
    const float highest = decode_energy(highest_energy_code);
    first = std::max(first, run.first);
    last = std::min(last, run.end - 1);
    for (; first <= last; first += most) {
        const int count = std::min(most, last - first + 1);
        const auto given = static_cast<std::size_t>(count);
        decode_energies({&run.energy(first), given}, energies);
        // At the ends of a column, the entry itself replaces the missing neighbour. The same holds
        // at the ends of a run, where both are 0.
        const int before = std::max(first - 1, run.first),
                  behind = std::min(first + count, run.end - 1);
        const bool at_begin = before == first;
        const auto there = std::span(field).subspan(at_begin ? 1 : 0);
        decode_fields({run.codes + (before - run.first), run.codes + (behind - run.first) + 1},
                      there);
        if (at_begin) field[0] = field[1];
        if (behind == first + count - 1) field[given + 1] = field[given];
        for (int n = 0; n < count; ++n) {
            const auto at = static_cast<std::size_t>(n);
            const auto code = run.energy(first + n);
            out[first + n] =
                code >= protected_code
                    ? code
                    : encode_energy(std::min(
                          energies[at] + step_prices_.edge * std::abs(field[at + 2] - field[at]),
                          highest));
        }
    }
}

void EnergyVolume::count_edges(const Limits& limits) {
    field_->add_energies(limits);
    each_in_parallel(columns_per_frame() * frames(), 4096, [&](std::size_t c) {
        const auto& run = field(c);
        std::copy_n(codes_of(c) + run.first, run.end - run.first, run.energies);
        set_edges(c, 0, width() - 1);
    });
}

void EnergyVolume::find_marks() {
    struct Found {
        std::size_t guarded = 0, attracted = 0;
        std::uint16_t highest = 0;
    };
    const auto found = tbb::parallel_reduce(
        ColumnRange(0, columns_per_frame() * frames(), 4096), Found{},
        [&](const ColumnRange& range, Found out) {
            for (auto c = range.begin(); c < range.end(); ++c) {
                const auto* const codes =
                    this->codes(c / columns_per_frame()).data() + c % columns_per_frame() * stride_;
                for (int entry = 0; entry < width(); ++entry) {
                    const auto code = codes[entry];
                    if (code < protected_code) out.highest = std::max(out.highest, code);
                    else ++(code == protected_code ? out.guarded : out.attracted);
                }
            }
            return out;
        },
        [](const Found& a, const Found& b) {
            return Found{a.guarded + b.guarded, a.attracted + b.attracted,
                         std::max(a.highest, b.highest)};
        });
    const float attraction =
        attraction_of_highest * (found.highest > 0 ? decode_energy(found.highest) : 1.0f);
    marks_ = {found.guarded > 0, found.attracted, attraction, attraction};
}

EnergyVolume EnergyVolume::sum() const {
    std::vector<float> sums(stride_ * columns_per_frame()), energies(attracts() ? sums.size() : 0);
    tbb::parallel_for(ColumnRange(0, sums.size(), 4096), [&](const ColumnRange& range) {
        std::vector<double> part(range.size(), 0.0);
        std::vector<std::size_t> attracted(energies.empty() ? 0 : range.size(), 0);
        for (std::size_t t = 0; t < frames(); ++t)
            for (std::size_t n = 0; n < part.size(); ++n) {
                const auto code = codes(t)[range.begin() + n];
                if (code == attracted_code) ++attracted[n];
                else part[n] += EntryCosts{}(code);
            }
        for (std::size_t n = 0; n < part.size(); ++n) {
            const auto at = range.begin() + n;
            if (!energies.empty()) {
                energies[at] = static_cast<float>(part[n]);
                part[n] -=
                    static_cast<double>(attracted[n]) * static_cast<double>(marks_.attraction);
            }
            sums[at] = static_cast<float>(part[n]);
        }
    });
    const auto summed = static_cast<float>(frames());
    auto shape = shape_;
    shape.frames = 1;
    EnergyVolume out(shape, {}, std::move(sums));
    out.stride_ = stride_;
    out.energies_ = std::move(energies);
    out.marks_ = marks_;
    out.marks_.barrier *= summed;
    out.spread_ = spread_;
    out.step_prices_.rigidity = {step_prices_.rigidity[0] * summed, 0};
    return out;
}

void EnergyVolume::hand_on(std::size_t column, int entry, Window window) {
    const Window near{std::max(entry - spread_, window.first),
                      std::min(entry + spread_, window.last)};
    if (summed()) {
        auto* const costs = sums_.data() + column * stride_;
        auto* const energies = energies_.empty() ? nullptr : energies_.data() + column * stride_;
        const auto cost_at = [&](int e) { return costs[e]; };
        share(
            entry, near,
            [&](int e) { return !std::isinf(costs[e]) && (!energies || energies[e] == costs[e]); },
            cost_at, cost_at,
            [&](int e, float energy) {
                costs[e] = energy;
                if (energies) energies[e] = energy;
            });
        return;
    }
    // In the field's run, energies without edges are stored separately.
    const auto* const run = edges_counted() ? &field(column) : nullptr;
    auto* const codes = codes_of(column);
    const float highest = decode_energy(highest_energy_code);
    const auto share_codes = [&](const auto& code) {
        const auto energy_at = [&](int e) { return decode_energy(code(e)); };
        share(
            entry, near, [&](int e) { return code(e) < protected_code; }, energy_at,
            [&](int e) {
                return run && spreads_edges_ ? decode_energy(codes[e]) - energy_at(e)
                                             : energy_at(e);
            },
            [&](int e, float energy) { code(e) = encode_energy(std::min(energy, highest)); });
    };
    if (!run || run->end <= near.first || run->first > near.last)
        share_codes([&](int e) -> std::uint16_t& { return codes[e]; });
    else if (run->has(near.first) && run->has(near.last))
        share_codes([&](int e) -> std::uint16_t& { return run->energy(e); });
    else
        share_codes(
            [&](int e) -> std::uint16_t& { return run->has(e) ? run->energy(e) : codes[e]; });
}

void EnergyVolume::remove(std::span<const std::uint16_t> at, Window window) {
    if (attracts()) marks_.attracted -= met(at).attracted;
    const auto columns = columns_per_frame();
    const int left = --shape_.lattice[0];
    const auto close = [&](auto* column, std::size_t entry) {
        std::memmove(column + entry, column + entry + 1,
                     (static_cast<std::size_t>(left) - entry) * sizeof(*column));
    };
    each_in_parallel(columns * frames(), 4096, [&](std::size_t c) {
        if (spread_ > 0) hand_on(c, at[c], window);
        if (summed()) close(sums_.data() + c * stride_, at[c]);
        else close(codes_of(c), at[c]);
        if (!energies_.empty()) close(energies_.data() + c * stride_, at[c]);
        if (field_) field_->runs()[c].remove(at[c], left, codes_of(c));
        // Update the entries that got energy or a new neighbour.
        if (edges_counted())
            set_edges(c, std::max(at[c] - 1 - spread_, 0), std::min(at[c] + spread_, left - 1));
    });
}

EnergyVolume::Met EnergyVolume::met(std::span<const std::uint16_t> at) const {
    const auto columns = columns_per_frame();
    // Number of summed frames that attract at an entry.
    const auto attracted_at = [&](std::size_t place) -> std::size_t {
        if (energies_.empty() || !std::isfinite(sums_[place])) return 0;
        return static_cast<std::size_t>(
            std::lround((energies_[place] - sums_[place]) / marks_.attraction));
    };
    return tbb::parallel_reduce(
        ColumnRange(0, columns * frames(), 4096), Met{},
        [&](const ColumnRange& range, Met out) {
            for (auto c = range.begin(); c < range.end(); ++c) {
                if (summed()) {
                    const auto place = c * stride_ + at[c];
                    out.zeros += sums_[place] == 0;
                    out.attracted += attracted_at(place);
                    out.blocked += std::isinf(sums_[place]);
                } else {
                    const auto code = codes(c / columns)[c % columns * stride_ + at[c]];
                    out.zeros += code == 0;
                    out.attracted += code == attracted_code;
                    out.blocked += code == protected_code;
                }
            }
            return out;
        },
        [](const Met& a, const Met& b) {
            return Met{a.zeros + b.zeros, a.attracted + b.attracted, a.blocked + b.blocked};
        });
}

}  // namespace fluidcarve
