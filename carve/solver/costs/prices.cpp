#include "carve/solver/costs/prices.h"

#include "carve/base/each_in_parallel.h"
#include "carve/base/failure.h"
#include "carve/solver/costs/summed_over.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace fluidcarve {

namespace {

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
    Typical out;
    if (energy.has_field()) {
        const auto extent = summed_over<Bounds>(energy, [&](Bounds& sum, std::size_t c) {
            const auto& field = energy.field(c);
            for (int entry = field.first; entry < field.end; ++entry)
                sum += Bounds{field.value(entry), field.value(entry)};
            if (field.end - field.first < width) sum += Bounds{0, 0};
        });
        if (extent.low == extent.high)
            throw Failure(
                fmt::format("`field` is {:g} at all vertices of the lattice in all frames: it "
                            "shows no content and no edges; connect the grid that people see, "
                            "such as the density, or leave `field` out",
                            extent.low));
        out.content = content_share * std::max(std::abs(extent.low), std::abs(extent.high));
    }
    const auto sums = summed_over<Sums>(energy, [&](Sums& sum, std::size_t c) {
        const auto* const codes = energy.codes(0) + c * energy.stride();
        const auto* const field = energy.has_field() ? &energy.field(c) : nullptr;
        // Beyond the field's run there is no content.
        for (int entry = field ? field->first : 0; entry < (field ? field->end : width); ++entry) {
            if (codes[entry] >= protected_code ||
                (field ? std::abs(field->value(entry)) <= out.content : codes[entry] == 0))
                continue;
            ++sum.count;
            sum.energy += decode_energy(codes[entry]);
            if (field)
                sum.edge += std::abs(field->value(std::min(entry + 1, width - 1)) -
                                     field->value(std::max(entry - 1, 0)));
        }
    });
    if (sums.energy > 0) out.energy = sums.energy / static_cast<double>(sums.count);
    if (sums.edge > 0) out.edge = sums.edge / static_cast<double>(sums.count);
    return out;
}

void add_prices(EnergyVolume& energy, const Typical& typical, const Prices& prices,
                const Limits& limits) {
    const auto unit = static_cast<float>(typical.energy);
    energy.set_step_prices(
        {.rigidity = {unit * prices.rigidity[0], unit * prices.rigidity[1]},
         .free_in_nothing = prices.free_in_nothing,
         .edge = static_cast<float>(prices.edges * typical.energy / typical.edge)});
    if (!energy.has_field()) return;
    const float most = decode_energy(highest_energy_code),
                empty = unit * prices.empty * (2 + prices.edges);
    each_in_parallel(energy.frames() * energy.columns_per_frame(), 256, [&](std::size_t c) {
        auto* const codes = energy.codes(0).data() + c * energy.stride();
        const auto& field = energy.field(c);
        for (int entry = 0; entry < energy.width(); ++entry) {
            if (codes[entry] >= protected_code) continue;
            const bool content = std::abs(field.value(entry)) > typical.content;
            codes[entry] = encode_energy(
                std::min(decode_energy(codes[entry]) + (content ? unit : empty), most));
        }
    });
    energy.count_edges(limits);
}

}  // namespace fluidcarve
