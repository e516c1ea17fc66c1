#include "carve/solver/costs/slab_prices.h"

#include "carve/base/each_in_parallel.h"
#include "carve/base/failure.h"
#include "carve/solver/costs/decode.h"
#include "carve/solver/costs/prices.h"
#include "carve/solver/costs/summed_over.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace fluidcarve {

namespace {

constexpr float slope_weight = 4;  ///< of differences of slope, beside differences of value
/// Field at which visibility is a half, in mean fields of content.
constexpr float level_of_mean = 0.5f;
constexpr double outline_price = 1;  ///< of an outline in a slab, in mean prices of content
constexpr double keep_away = 3;      ///< factor by which a slab is dearer where another was taken
constexpr double away = 3;           ///< distance from a taken slab up to which slabs are dearer,
                                     ///< thicknesses

/// Vertices on either side of a slab's face over which both sides are compared; they are faded over
/// as many.
int overlap(int thickness) { return static_cast<int>(std::lround(0.6 * thickness)); }

double ratio(double of, double unit) { return unit > 0 ? of / unit : 0; }

/// The code of a slab's price, raised where others were taken nearby.
/// @param column  as in Seams::Seam::at
std::uint16_t kept_away(double price, std::size_t column, int entry, int thickness,
                        std::span<const SlabPrices::Taken> all_taken) {
    for (const auto& taken : all_taken) {
        const double apart =
            std::abs(entry + 0.5 * (thickness - taken.thickness) - taken.at[column]) /
            (away * thickness);
        price *= 1 + keep_away * std::max(0.0, 1 - apart);
    }
    const double most = decode_energy(highest_energy_code);
    return encode_energy(static_cast<float>(std::min(price, most)));
}

/// Writes the codes of a column's slabs: those of their marked entries, or their prices.
/// @param codes     of the entries
/// @param price_of  code of a slab without a marked entry
template <class PriceOf>
void write_slabs(const std::uint16_t* codes, int thickness, std::span<std::uint16_t> to,
                 const PriceOf& price_of) {
    // The last marked entries up to the slab's last.
    int blocked = -1, attracted = -1;
    const auto mark = [&](int entry) {
        if (codes[entry] == protected_code) blocked = entry;
        if (codes[entry] == attracted_code) attracted = entry;
    };
    for (int entry = 0; entry < thickness - 1; ++entry) mark(entry);
    for (int entry = 0; entry < static_cast<int>(to.size()); ++entry) {
        mark(entry + thickness - 1);
        to[static_cast<std::size_t>(entry)] = blocked >= entry     ? protected_code
                                              : attracted >= entry ? attracted_code
                                                                   : price_of(entry);
    }
}

/// Averages rows of numbers with the rows before and behind.
/// @param count    of rows in a line
/// @param stride   from a row to the next
/// @param lines    of rows
/// @param between  from a line to the next
/// @param size     of a row
/// @param ring     whether the last row of a line stands before the first
void smooth(std::vector<float>& values, std::size_t count, std::size_t stride, std::size_t lines,
            std::size_t between, std::size_t size, bool ring) {
    if (count == 1) return;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, lines),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          std::vector<float> copy(count * size);
                          for (auto line = range.begin(); line < range.end(); ++line) {
                              auto* const first = values.data() + line * between;
                              for (std::size_t n = 0; n < count; ++n)
                                  std::copy_n(first + n * stride, size, copy.data() + n * size);
                              for (std::size_t n = 0; n < count; ++n) {
                                  const auto* const before = copy.data() + (n > 0  ? n - 1
                                                                            : ring ? count - 1
                                                                                   : 0) *
                                                                               size;
                                  const auto* const here = copy.data() + n * size;
                                  const auto* const behind = copy.data() + (n + 1 < count ? n + 1
                                                                            : ring        ? 0
                                                                                          : n) *
                                                                               size;
                                  for (std::size_t e = 0; e < size; ++e)
                                      first[n * stride + e] =
                                          (before[e] + here[e] + behind[e]) * (1.0f / 3);
                              }
                          }
                      });
}

}  // namespace

/// One column: the terms of the prices of its slabs, as running sums.
class SlabPrices::Column {
public:
    Column(const SlabPrices& prices, int width, int thickness)
        : prices_(prices),
          width_(width),
          thickness_(thickness),
          half_(overlap(thickness)),
          pad_(half_ + thickness + 1),
          field_(static_cast<std::size_t>(width + 2 * pad_)),
          seen_(field_.size()),
          slope_(field_.size()),
          energy_(static_cast<std::size_t>(width)),
          differences_(field_.size() + 1),
          energies_(energy_.size() + 1),
          outlines_(field_.size() + 1),
          contents_(field_.size() + 1) {}

    /// @param codes  energy codes of its entries
    void read(const FieldRun& field, std::span<const std::uint16_t> codes) {
        // Space beside a column is empty.
        field.read(0, std::span(field_).subspan(static_cast<std::size_t>(pad_),
                                                static_cast<std::size_t>(width_)));
        const auto size = field_.size();
        for (std::size_t n = 0; n < size; ++n)
            seen_[n] = field_[n] / (std::abs(field_[n]) + prices_.level_);
        for (std::size_t n = 1; n + 1 < size; ++n) slope_[n] = 0.5f * (seen_[n + 1] - seen_[n - 1]);
        const auto thick = static_cast<std::size_t>(thickness_);
        const auto content = [&](std::size_t n) {
            return std::abs(field_[n]) > prices_.content_ ? 1 : 0;
        };
        // Content is the mean of three entries, so that a single entry counts less.
        const auto around = [&](std::size_t n) {
            return n == 0 || n + 1 >= size ? 0 : content(n - 1) + content(n) + content(n + 1);
        };
        for (std::size_t n = 0; n < size; ++n) {
            const float value = n + thick < size ? seen_[n] - seen_[n + thick] : 0,
                        slope = n + thick < size ? slope_[n] - slope_[n + thick] : 0;
            differences_[n + 1] = differences_[n] + value * value + slope_weight * slope * slope;
            contents_[n + 1] = contents_[n] + content(n);
            outlines_[n + 1] = outlines_[n] + std::abs(around(n + 1) - around(n)) / 3.0;
        }
        decode_energies(codes, energy_);
        for (std::size_t n = 0; n < energy_.size(); ++n)
            energies_[n + 1] = energies_[n] + (codes[n] < protected_code ? energy_[n] : 0);
    }

    /// Sums of the costs of slabs with content.
    struct Means {
        Sum join, energy;
        Means& operator+=(const Means& other) {
            join += other.join;
            energy += other.energy;
            return *this;
        }
    };
    static Means means(const SlabPrices& prices, const EnergyVolume& volume, int thickness) {
        const int width = volume.width();
        return tbb::parallel_deterministic_reduce(
            tbb::blocked_range<std::size_t>(0, volume.columns_per_frame() * volume.frames(), 1024),
            Means{},
            [&](const tbb::blocked_range<std::size_t>& range, Means out) {
                Column column(prices, width, thickness);
                for (auto c = range.begin(); c < range.end(); ++c) {
                    column.read(volume.field(c), {volume.codes(0) + c * volume.stride(),
                                                  static_cast<std::size_t>(width)});
                    for (int entry = 0; entry + thickness <= width; ++entry) {
                        if (!column.content(entry)) continue;
                        out.join += Sum{column.join(entry), 1};
                        out.energy += Sum{column.energy(entry), 1};
                    }
                }
                return out;
            },
            [](Means a, const Means& b) { return a += b; });
    }

    // For the slab that begins at an entry:
    bool content(int entry) const {
        return over(contents_, entry - half_, entry + thickness_ + half_) > 0;
    }
    /// Root mean square of the difference of both sides.
    double join(int entry) const {
        return std::sqrt(std::max(over(differences_, entry - half_, entry + half_), 0.0) /
                         (2 * half_ + 1));
    }
    double energy(int entry) const {
        const auto first = static_cast<std::size_t>(entry);
        return std::max(energies_[first + static_cast<std::size_t>(thickness_)] - energies_[first],
                        0.0) /
               thickness_;
    }
    double outlines(int entry) const { return over(outlines_, entry, entry + thickness_ - 1); }

private:
    /// Sum over entries.
    double over(const std::vector<double>& sums, int first, int last) const {
        const int from = first + pad_, end = last + pad_ + 1;
        return sums[static_cast<std::size_t>(end)] - sums[static_cast<std::size_t>(from)];
    }

    const SlabPrices& prices_;
    int width_, thickness_, half_, pad_;
    std::vector<float> field_, seen_, slope_;  ///< with what lies beside the column
    std::vector<float> energy_;
    std::vector<double> differences_, energies_, outlines_, contents_;  ///< sums up to an entry
};

SlabPrices::SlabPrices(const EnergyVolume& volume, int thickness, const SlabWeights& weights)
    : weights_(weights) {
    const auto each = [&](const FieldRun& field, const auto& visit) {
        for (int entry = field.first; entry < field.end; ++entry)
            visit(entry, std::abs(field.value(entry)));
    };
    const auto most = summed_over<Greatest>(volume, [&](Greatest& out, std::size_t c) {
        each(volume.field(c), [&](int, float value) { out += Greatest{value}; });
    });
    if (most.value == 0)
        throw Failure(
            "`field` is 0 at all vertices of the lattice: nothing is seen there; connect the grid "
            "that is rendered, or set `thickness: 1`");
    content_ = Typical::content_share * most.value;
    const auto field = summed_over<Sum>(volume, [&](Sum& out, std::size_t c) {
        each(volume.field(c), [&](int, float value) {
            if (value > content_) out += Sum{value, 1};
        });
    });
    level_ = level_of_mean * static_cast<float>(field.mean());
    const auto means = Column::means(*this, volume, thickness);
    join_ = means.join.mean();
    energy_ = means.energy.mean();
}

std::vector<float> SlabPrices::frame(const EnergyVolume& volume, int thickness,
                                     std::size_t t) const {
    const int width = volume.width(), begins = width - thickness + 1;
    const auto columns = volume.columns_per_frame(), slabs = static_cast<std::size_t>(begins);
    std::vector<float> out(columns * slabs);
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, columns, 256),
        [&](const tbb::blocked_range<std::size_t>& range) {
            Column column(*this, width, thickness);
            for (auto c = range.begin(); c < range.end(); ++c) {
                column.read(volume.field(t * columns + c), {volume.codes(t) + c * volume.stride(),
                                                            static_cast<std::size_t>(width)});
                for (std::size_t n = 0; n < slabs; ++n) {
                    const int entry = static_cast<int>(n);
                    out[c * slabs + n] =
                        static_cast<float>(weights_.join * ratio(column.join(entry), join_) +
                                           ratio(column.energy(entry), energy_) +
                                           outline_price * unit() * column.outlines(entry));
                }
            }
        });
    const auto laterals = static_cast<std::size_t>(volume.laterals()),
               slices = static_cast<std::size_t>(volume.slices());
    smooth(out, laterals, slabs, slices, laterals * slabs, slabs, volume.shape().around);
    smooth(out, slices, laterals * slabs, laterals, slabs, slabs, volume.shape().closed);
    return out;
}

void SlabPrices::set_empty(EnergyVolume& prices, const EnergyVolume& volume, int thickness,
                           float empty, std::span<const Taken> all_taken) const {
    const auto columns = prices.columns_per_frame();
    const int beside = overlap(thickness);
    each_in_parallel(columns * prices.frames(), 256, [&](std::size_t c) {
        const auto& field = volume.field(c);
        auto* const to = prices.codes(c / columns).data() + c % columns * prices.stride();
        int next = field.first, seen = -beside - 1;  // the last entry where something is
        for (int entry = 0; entry < prices.width(); ++entry) {
            for (; next < std::min(field.end, entry + thickness + beside + 1); ++next)
                if (std::abs(field.value(next)) > content_) seen = next;
            if (seen < entry - beside && to[entry] <= highest_energy_code)
                to[entry] = kept_away(empty * unit(), c, entry, thickness, all_taken);
        }
    });
}

EnergyVolume SlabPrices::priced(const EnergyVolume& volume, int thickness, float empty,
                                std::span<const Taken> all_taken, const Limits& limits) const {
    const int slabs = volume.width() - thickness + 1;
    auto shape = volume.shape();
    shape.lattice[0] = slabs;
    EnergyVolume out(shape, limits);
    // The frame, and its neighbours before and behind.
    std::array<std::vector<float>, 3> frames{frame(volume, thickness, 0), {}, {}};
    frames[1] = frames[0];
    const auto columns = volume.columns_per_frame();
    for (std::size_t t = 0; t < volume.frames(); ++t) {
        frames[2] = t + 1 < volume.frames() ? frame(volume, thickness, t + 1) : frames[1];
        each_in_parallel(columns, 256, [&](std::size_t c) {
            const auto* const codes = volume.codes(t) + c * volume.stride();
            auto* const to = out.codes(t).data() + c * out.stride();
            write_slabs(codes, thickness, {to, static_cast<std::size_t>(slabs)}, [&](int entry) {
                const auto at =
                    c * static_cast<std::size_t>(slabs) + static_cast<std::size_t>(entry);
                const double price = (frames[0][at] + frames[1][at] + frames[2][at]) / 3.0;
                return kept_away(price, t * columns + c, entry, thickness, all_taken);
            });
        });
        frames[0] = std::move(frames[1]);
        frames[1] = std::move(frames[2]);
    }
    set_empty(out, volume, thickness, empty, all_taken);
    out.set_slabs(volume);
    const auto step = static_cast<float>(unit());
    out.set_step_prices({.rigidity = {step * weights_.rigidity[0], step * weights_.rigidity[1]}});
    if (volume.attracts() || volume.protects()) out.find_marks();
    return out;
}

double SlabPrices::content_share(const EnergyVolume& volume, std::span<const std::uint16_t> at,
                                 int thickness, Window window) const {
    struct Widths {
        double taken = 0, all = 0;
        Widths& operator+=(const Widths& other) {
            taken += other.taken;
            all += other.all;
            return *this;
        }
    };
    const auto widths = summed_over<Widths>(volume, [&](Widths& out, std::size_t c) {
        const auto& field = volume.field(c);
        const auto seen = [&](int entry) { return std::abs(field.value(entry)) > content_; };
        int first = std::max(field.first, window.first),
            last = std::min(field.end - 1, window.last);
        while (first <= last && !seen(first)) ++first;
        while (first <= last && !seen(last)) --last;
        if (first > last) return;
        out += {static_cast<double>(std::max(
                    0, std::min(last + 1, at[c] + thickness) - std::max<int>(first, at[c]))),
                static_cast<double>(last + 1 - first)};
    });
    return widths.all > 0 ? widths.taken / widths.all * window.size() / thickness : 1;
}

}  // namespace fluidcarve
