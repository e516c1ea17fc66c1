#include "nodes/seam/energy/prices.h"

#include "graph/text/problem.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

namespace fluidcarve {

namespace {

/// Calls `visit(sum, column)` for all columns and adds partial sums in a fixed order, so that the result does not depend on the threads.
template <class Sum, class Visit>
Sum summed_over(const EnergyVolume& energy, const Visit& visit) {
    const auto columns = energy.columns_per_frame() * energy.frames();
    return tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, columns, 4096), Sum{},
        [&](const tbb::blocked_range<std::size_t>& range, Sum sum) {
            for (auto c = range.begin(); c < range.end(); ++c) visit(sum, c);
            return sum;
        },
        [](Sum a, const Sum& b) { return a += b; });
}

struct Bounds {
    float low = std::numeric_limits<float>::infinity(), high = -low;
    Bounds& operator+=(const Bounds& other) {
        low = std::min(low, other.low);
        high = std::max(high, other.high);
        return *this;
    }
};

struct Sums {
    double energy = 0, edge = 0;
    std::size_t count = 0;
    Sums& operator+=(const Sums& other) {
        energy += other.energy;
        edge += other.edge;
        count += other.count;
        return *this;
    }
};

}  // namespace

Typical Typical::of(const EnergyVolume& energy) {
    const auto width = energy.width();
    const auto* const codes = energy.codes(0);
    const auto* const field = energy.has_field() ? energy.field(0).data() : nullptr;
    const auto value = [&](std::size_t place) { return decode_field(field[place]); };
    Typical out;
    if (field) {
        const auto extent = summed_over<Bounds>(energy, [&](Bounds& sum, std::size_t c) {
            for (auto n = c * energy.stride(); n < c * energy.stride() + static_cast<std::size_t>(width); ++n) sum += Bounds{value(n), value(n)};
        });
        if (extent.low == extent.high)
            throw Failure(
                fmt::format("`field` is {:g} at all vertices of the lattice in all frames: it shows no content and no edges; connect the grid that people see, "
                            "such as the density, or leave `field` out",
                            extent.low));
        out.content = content_share * std::max(std::abs(extent.low), std::abs(extent.high));
    }
    const auto sums = summed_over<Sums>(energy, [&](Sums& sum, std::size_t c) {
        const auto first = c * energy.stride();
        for (int entry = 0; entry < width; ++entry) {
            const auto n = first + static_cast<std::size_t>(entry);
            if (codes[n] >= protected_code || (field ? std::abs(value(n)) <= out.content : codes[n] == 0)) continue;
            ++sum.count;
            sum.energy += decode_energy(codes[n]);
            if (field)
                sum.edge += std::abs(value(first + static_cast<std::size_t>(std::min(entry + 1, width - 1))) -
                                     value(first + static_cast<std::size_t>(std::max(entry - 1, 0))));
        }
    });
    if (sums.energy > 0) out.energy = sums.energy / static_cast<double>(sums.count);
    if (sums.edge > 0) out.edge = sums.edge / static_cast<double>(sums.count);
    return out;
}

void set_prices(EnergyVolume& energy, const Typical& typical, const Prices& prices) {
    const auto unit = static_cast<float>(typical.energy);
    energy.set_rigidity({unit * prices.rigidity[0], unit * prices.rigidity[1]});
    if (!energy.has_field()) return;
    energy.set_field_weight(static_cast<float>(prices.edges * typical.energy / typical.edge));
    const float most = decode_energy(highest_energy_code), empty = unit * prices.empty * (2 + prices.edges);
    auto* const codes = energy.codes(0).data();
    const auto* const field = std::as_const(energy).field(0).data();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, energy.frames() * energy.columns_per_frame() * energy.stride(), 65536),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (auto n = range.begin(); n < range.end(); ++n) {
                              if (codes[n] >= protected_code) continue;
                              const bool content = std::abs(decode_field(field[n])) > typical.content;
                              codes[n] = encode_energy(std::min(decode_energy(codes[n]) + (content ? unit : empty), most));
                          }
                      });
}

}  // namespace fluidcarve
