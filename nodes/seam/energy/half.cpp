#include "nodes/seam/energy/half.h"

#include "nodes/seam/energy/code.h"
#include "nodes/seam/energy/decode.h"
#include "nodes/vectors/wide.h"

#include <tbb/parallel_for.h>

#include <vector>

namespace fluidcarve {

namespace {

/// Codes that are averaged by one thread at a time.
constexpr std::size_t grain = 65536;

/// The mean of the energies of some columns, at half their length.
class MeanEnergy {
public:
    explicit MeanEnergy(std::size_t width) : energies_(width), sums_(halved(width)), marks_(halved(width)) {}

    void add(std::span<const std::uint16_t> codes) {
        if (std::ranges::max(codes) < protected_code) decode_energies(codes, energies_);
        else read_marks(codes);
        add_pairs(energies_, sums_);
        ++columns_;
    }
    void end(std::span<std::uint16_t> out) {
        for (std::size_t n = 0; n < out.size(); ++n) {
            const bool guarded = marks_[n].guarded || (n > 0 && marks_[n - 1].guarded) || (n + 1 < out.size() && marks_[n + 1].guarded);
            out[n] = guarded ? protected_code : marks_[n].attracted ? attracted_code : encode_energy(sums_[n] / columns_);
        }
        std::ranges::fill(sums_, 0.0f);
        std::ranges::fill(marks_, Marks{});
        columns_ = 0;
    }

private:
    struct Marks {
        bool guarded = false, attracted = false;
    };
    /// The same as decoding, where some are marked: these have no energy.
    void read_marks(std::span<const std::uint16_t> codes) {
        for (std::size_t n = 0; n < codes.size(); ++n) {
            energies_[n] = codes[n] < protected_code ? decode_energy(codes[n]) : 0;
            if (codes[n] == protected_code) marks_[n / 2].guarded = true;
            if (codes[n] == attracted_code) marks_[n / 2].attracted = true;
        }
    }

    std::vector<float> energies_, sums_;
    std::vector<Marks> marks_;
    float columns_ = 0;
};

/// Whether all codes are 0, as in empty space, which is most of many lattices.
bool all_zero(std::span<const std::uint16_t> codes) {
    constexpr std::size_t at_once = 64;
    for (std::size_t n = 0; n < codes.size(); n += at_once) {
        unsigned any = 0;
        for (const auto code : codes.subspan(n, std::min(at_once, codes.size() - n))) any |= code;
        if (any != 0) return false;
    }
    return true;
}

template <class Mean>
void halve(std::span<const std::uint16_t> codes, const ColumnShape& shape, std::span<std::uint16_t> out) {
    const auto [width, laterals, planes] = shape;
    const auto coarse_width = halved(width), coarse_laterals = halved(laterals);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, coarse_laterals * halved(planes), 16),
                      [&, width = width, laterals = laterals, planes = planes](const tbb::blocked_range<std::size_t>& range) {
                          Mean mean(width);
                          for (auto c = range.begin(); c < range.end(); ++c) {
                              const auto lateral = 2 * (c % coarse_laterals), k = 2 * (c / coarse_laterals);
                              const auto coarse = out.subspan(c * coarse_width, coarse_width);
                              bool empty = true;
                              for (auto fk = k; fk < std::min(k + 2, planes); ++fk)
                                  empty =
                                      empty && all_zero(codes.subspan((lateral + laterals * fk) * width, width * (std::min(lateral + 2, laterals) - lateral)));
                              if (empty) {
                                  std::ranges::fill(coarse, std::uint16_t{0});
                                  continue;
                              }
                              for (auto fk = k; fk < std::min(k + 2, planes); ++fk)
                                  for (auto fl = lateral; fl < std::min(lateral + 2, laterals); ++fl)
                                      mean.add(codes.subspan((fl + laterals * fk) * width, width));
                              mean.end(coarse);
                          }
                      });
}

template <class Average>
void average(std::span<const std::uint16_t> codes, std::span<std::uint16_t> out, const Average& of) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, out.size(), grain), [&](const tbb::blocked_range<std::size_t>& range) {
        for (auto n = range.begin(); n < range.end(); ++n) out[n] = of(codes[n], out[n]);
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

void MeanField::add(std::span<const std::uint16_t> codes) {
    decode_fields(codes, values_);
    for (std::size_t n = 0; n < codes.size() / 2; ++n) sums_[n] += values_[2 * n] + values_[2 * n + 1];
    // The last of an odd number counts twice, and is halved with the others.
    if (codes.size() % 2 != 0) sums_.back() += 2 * values_.back();
    ++columns_;
}

void MeanField::end(std::span<std::uint16_t> out) {
    for (std::size_t n = 0; n < out.size(); ++n) out[n] = encode_field(sums_[n] / (2 * columns_));
    std::ranges::fill(sums_, 0.0f);
    columns_ = 0;
}

void halve_energy(std::span<const std::uint16_t> codes, const ColumnShape& shape, std::span<std::uint16_t> out) { halve<MeanEnergy>(codes, shape, out); }

void halve_field(std::span<const std::uint16_t> codes, const ColumnShape& shape, std::span<std::uint16_t> out) { halve<MeanField>(codes, shape, out); }

void average_energy(std::span<const std::uint16_t> codes, std::span<std::uint16_t> out) {
    average(codes, out, [](std::uint16_t a, std::uint16_t b) {
        for (const auto mark : {protected_code, attracted_code})
            if (a == mark || b == mark) return mark;
        return encode_energy(0.5f * (decode_energy(a) + decode_energy(b)));
    });
}

void average_field(std::span<const std::uint16_t> codes, std::span<std::uint16_t> out) {
    average(codes, out, [](std::uint16_t a, std::uint16_t b) { return encode_field(0.5f * (decode_field(a) + decode_field(b))); });
}

}  // namespace fluidcarve
