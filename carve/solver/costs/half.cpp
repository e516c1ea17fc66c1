#include "carve/solver/costs/half.h"

#include "carve/simd/wide.h"
#include "carve/solver/costs/code.h"
#include "carve/solver/costs/decode.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>

namespace fluidcarve {

namespace {

/// Codes that are averaged by one thread at a time.
constexpr std::size_t grain = 65536;

template <class Average>
void average(std::span<const std::uint16_t> codes, std::span<std::uint16_t> out,
             const Average& of) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, out.size(), grain),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (auto n = range.begin(); n < range.end(); ++n)
                              out[n] = of(codes[n], out[n]);
                      });
}

}  // namespace

FLUIDCARVE_WIDE void add_pairs(std::span<const float> energies, std::span<float> sums) {
    const auto* const of = energies.data();
    auto* const to = sums.data();
    const auto pairs = energies.size() / 2;
    for (std::size_t n = 0; n < pairs; ++n) to[n] += cost_of_pair(of[2 * n], of[2 * n + 1]);
    if (energies.size() % 2 != 0) to[pairs] += of[energies.size() - 1];
}

void MeanColumn::count(std::size_t from, std::size_t size) {
    ++columns_;
    if (size == 0) return;
    const auto first = from / 2, end = halved(from + size);
    first_ = end_ == 0 ? first : std::min(first_, first);
    end_ = std::max(end_, end);
}

void MeanColumn::reset() {
    std::fill(sums_.begin() + static_cast<std::ptrdiff_t>(first_),
              sums_.begin() + static_cast<std::ptrdiff_t>(end_), 0.0f);
    first_ = end_ = 0;
    columns_ = 0;
}

void MeanEnergy::add(std::span<const std::uint16_t> codes, std::size_t from) {
    count(from, codes.size());
    if (codes.empty()) return;
    const auto energies = std::span(values_).first(codes.size());
    if (std::ranges::max(codes) < protected_code) decode_energies(codes, energies);
    else read_marks(codes, from);
    add_pairs(energies, std::span(sums_).subspan(from / 2));
}

/// Decodes energies if some entries are marked; marked entries have no energy.
void MeanEnergy::read_marks(std::span<const std::uint16_t> codes, std::size_t from) {
    for (std::size_t n = 0; n < codes.size(); ++n) {
        values_[n] = codes[n] < protected_code ? decode_energy(codes[n]) : 0;
        auto& marks = marks_[(from + n) / 2];
        if (codes[n] == protected_code) marks.guarded = true;
        if (codes[n] == attracted_code) marks.attracted = true;
    }
}

void MeanEnergy::end(std::span<std::uint16_t> out) {
    std::ranges::fill(out, std::uint16_t{0});
    const auto guarded = [&](std::size_t n) { return n < marks_.size() && marks_[n].guarded; };
    for (auto n = first_ > 0 ? first_ - 1 : first_; n < std::min(end_ + 1, out.size()); ++n) {
        const bool near = guarded(n) || guarded(n + 1) || (n > 0 && guarded(n - 1));
        out[n] = near                  ? protected_code
                 : marks_[n].attracted ? attracted_code
                                       : encode_energy(sums_[n] / columns_);
    }
    std::fill(marks_.begin() + static_cast<std::ptrdiff_t>(first_),
              marks_.begin() + static_cast<std::ptrdiff_t>(end_), Marks{});
    reset();
}

void MeanField::add(std::span<const std::uint16_t> codes, std::size_t from) {
    count(from, codes.size());
    if (codes.empty()) return;
    const auto values = std::span(values_).first(codes.size());
    decode_fields(codes, values);
    std::size_t n = 0;
    if (from % 2 != 0) sums_[from / 2] += values[n++];
    auto* const sums = sums_.data() + halved(from);
    const auto pairs = (values.size() - n) / 2;
    for (std::size_t p = 0; p < pairs; ++p) sums[p] += values[n + 2 * p] + values[n + 2 * p + 1];
    n += 2 * pairs;
    // A last entry without a partner counts twice, since all sums are halved later.
    if (n < values.size())
        sums[pairs] += from + n + 1 == values_.size() ? 2 * values[n] : values[n];
}

void MeanField::end(std::span<std::uint16_t> out) {
    std::ranges::fill(out, std::uint16_t{0});
    for (auto n = first_; n < end_; ++n) out[n] = encode_field(sums_[n] / (2 * columns_));
    reset();
}

void average_energy(std::span<const std::uint16_t> codes, std::span<std::uint16_t> out) {
    average(codes, out, [](std::uint16_t a, std::uint16_t b) {
        for (const auto mark : {protected_code, attracted_code})
            if (a == mark || b == mark) return mark;
        return encode_energy(0.5f * (decode_energy(a) + decode_energy(b)));
    });
}

void average_field(std::span<const std::uint16_t> codes, std::span<std::uint16_t> out) {
    average(codes, out, [](std::uint16_t a, std::uint16_t b) {
        return encode_field(0.5f * (decode_field(a) + decode_field(b)));
    });
}

}  // namespace fluidcarve
