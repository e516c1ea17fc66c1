#include "carve/solver/costs/eddies.h"

#include "carve/solver/costs/prices.h"
#include "carve/solver/costs/summed_over.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace fluidcarve {

namespace {

/// Width of an eddy, in distances at which the correlation is a half.
constexpr double widths_of_half = 1.5;
constexpr std::size_t most_lags = 256;        ///< vertices: eddies are hardly wider
constexpr std::size_t most_columns = 20'000;  ///< measured columns; more are not needed

/// Sums of products of the content's values at each distance from each other.
struct Lags {
    std::vector<Sum> of;
    Lags& operator+=(const Lags& other) {
        of.resize(std::max(of.size(), other.of.size()));
        for (std::size_t n = 0; n < other.of.size(); ++n) of[n] += other.of[n];
        return *this;
    }
};

/// The distance at which correlations fall to a half, vertices.
double half_of(const Lags& lags) {
    if (lags.of.empty() || !(lags.of.front().value > 0)) return 0;
    const double half = 0.5 * lags.of.front().mean();
    std::size_t lag = 1;
    while (lag + 1 < lags.of.size() && lags.of[lag].mean() > half) ++lag;
    if (lag >= lags.of.size()) return 0;
    const double before = lags.of[lag - 1].mean(), behind = lags.of[lag].mean();
    const double part =
        before > behind ? std::clamp((before - half) / (before - behind), 0.0, 1.0) : 1;
    return static_cast<double>(lag - 1) + part;
}

/// Calls `visit(value)` for the field's values in a column.
template <class Visit>
void each_value(const EnergyVolume& volume, std::size_t c, const Visit& visit) {
    const auto& field = volume.field(c);
    for (int entry = field.first; entry < field.end; ++entry) visit(field.value(entry));
}

/// @param content  what is above shows
Lags lags_of(const EnergyVolume& volume, float content) {
    const auto mean = summed_over<Sum>(volume, [&](Sum& out, std::size_t c) {
                          each_value(volume, c, [&](float value) {
                              if (std::abs(value) > content) out += Sum{value, 1};
                          });
                      }).mean();
    const auto every = volume.columns_per_frame() * volume.frames() / most_columns + 1;
    return summed_over<Lags>(volume, [&](Lags& out, std::size_t c) {
        if (c % every != 0) return;
        std::vector<float> values;
        each_value(volume, c, [&](float value) {
            values.push_back(std::abs(value) > content ? value - static_cast<float>(mean)
                                                       : std::numeric_limits<float>::quiet_NaN());
        });
        const auto size = std::min(values.size(), most_lags);
        out.of.resize(std::max(out.of.size(), size));
        for (std::size_t lag = 0; lag < size; ++lag)
            for (std::size_t n = 0; n + lag < values.size(); ++n)
                if (const float product = values[n] * values[n + lag]; !std::isnan(product))
                    out.of[lag] += Sum{product, 1};
    });
}

/// By how much columns climb and fall, and their highest values, summed.
struct Climbs {
    double all = 0, highest = 0;
    Climbs& operator+=(const Climbs& other) {
        all += other.all;
        highest += other.highest;
        return *this;
    }
};

Climbs climbs_of(const EnergyVolume& volume) {
    return summed_over<Climbs>(volume, [&](Climbs& out, std::size_t c) {
        float highest = 0, before = 0, all = 0;
        each_value(volume, c, [&](float value) {
            all += std::abs(value - before);
            highest = std::max(highest, std::abs(value));
            before = value;
        });
        out += {all + std::abs(before), highest};
    });
}

}  // namespace

Eddies Eddies::of(const EnergyVolume& volume) {
    const auto most = summed_over<Greatest>(volume, [&](Greatest& out, std::size_t c) {
        each_value(volume, c, [&](float value) { out += Greatest{std::abs(value)}; });
    });
    const auto lags = lags_of(volume, Typical::content_share * most.value);
    const auto climbs = climbs_of(volume);
    Eddies out;
    out.width = std::max(1, static_cast<int>(std::lround(widths_of_half * half_of(lags))));
    if (climbs.highest > 0) out.across = climbs.all / (2 * climbs.highest);
    return out;
}

}  // namespace fluidcarve
