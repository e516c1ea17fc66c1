#pragma once

#include "carve/remap/voxels/blend.h"

#include <openvdb/Types.h>
#include <openvdb/math/Math.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

namespace fluidcarve {

template <class Part>
inline constexpr std::size_t components_of = openvdb::VecTraits<Part>::IsVec ? 3 : 1;

/// A value's components; missing ones are 0.
template <class Part>
std::array<double, 3> components(const Part& value) {
    if constexpr (openvdb::VecTraits<Part>::IsVec)
        return {static_cast<double>(value[0]), static_cast<double>(value[1]),
                static_cast<double>(value[2])};
    else return {static_cast<double>(value)};
}

/// How badly two vectors match, from 0 to 1.
/// @param fits, misfits  ratios of the shorter length to the longer one: 0 results from `fits` on,
///   1 up to `misfits`
inline double misfit(const std::array<double, 3>& a, const std::array<double, 3>& b, double fits,
                     double misfits) {
    double of_a = 0, of_b = 0, both = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        of_a += a[c] * a[c];
        of_b += b[c] * b[c];
        both += a[c] * b[c];
    }
    const double most = std::max(of_a, of_b), share = most == 0 ? 1
                                                      : both <= 0
                                                          ? 0
                                                          : std::sqrt(std::min(of_a, of_b) / most);
    const double x = std::clamp((fits - share) / (fits - misfits), 0.0, 1.0);
    return x * x * (3 - 2 * x);
}

/// The slow part and the value of a side, or of the wanted result.
struct Shown {
    std::array<double, 3> slow, value;
};

/// How badly a side matches the wanted result, from 0 to 1. Where the slow parts differ, an
/// outline would be cropped or doubled. Where one of the values is near 0, a smaller difference
/// counts.
inline double misfit(const Shown& side, const Shown& wanted) {
    return std::max(
        misfit(side.slow, wanted.slow, 0.7, 0.3),
        misfit(side.slow, wanted.slow, 0.9, 0.6) * misfit(side.value, wanted.value, 0.2, 0.05));
}

/// A blended value in two bands: its slow part and the rest, with the wanted slow part.
template <class Part>
struct TwoBands {
    Part faded, stretched;                    ///< `stretched`: the value at
                                              ///< JoinedSides::stretched()
    std::array<double, 3> shown{}, wanted{};  ///< the blended slow part; the slow part at
                                              ///< JoinedSides::stretched()
    double stretch = 0;  ///< share of `stretched` in the result: the weighted misfit of the sides
    double squares = 0;  ///< sum of the squares of the sides' weights
    double highest = 0;  ///< largest magnitude of all values, if they are scalars

    /// Adds a side's slow part and its misfit.
    void add(const Shown& side, double weight) {
        for (std::size_t c = 0; c < components_of<Part>; ++c) shown[c] += weight * side.slow[c];
        stretch += weight * misfit(side, {wanted, components(stretched)});
        squares += weight * weight;
    }
    /// The blended detail on the wanted slow part.
    Part value() const {
        // Averaging flattens details that do not match. They are taken to match half.
        const double gain = 1 / std::sqrt(0.5 * (1 + squares));
        const auto means = components(faded), ends = components(stretched);
        Part out = faded;
        for (std::size_t c = 0; c < components_of<Part>; ++c) {
            const double raised = shown[c] + (means[c] - shown[c]) * gain,
                         value = raised * means[c] > 0 ? raised : 0;
            // Dim places stay dim: where nothing is shown, nothing is added.
            const double share = shown[c] == 0 ? 0 : std::clamp(value / shown[c], 0.0, 1.0);
            const bool lower =
                wanted[c] * shown[c] >= 0 && std::abs(wanted[c]) < std::abs(shown[c]);
            const double whole =
                lower ? value * wanted[c] / shown[c] : value + share * (wanted[c] - shown[c]);
            const double mixed = whole + stretch * (ends[c] - whole);
            if constexpr (openvdb::VecTraits<Part>::IsVec)
                out[static_cast<int>(c)] =
                    static_cast<typename openvdb::VecTraits<Part>::ElementType>(mixed);
            else out = static_cast<Part>(std::clamp(mixed, -highest, highest));
        }
        return out;
    }
};

/// Blends the sides of a point in two bands (METHOD 10 "Joins").
template <class Part>
class BandBlend {
public:
    using Slow = std::array<double, 3>;

    /// @param stretched, slow  at JoinedSides::stretched()
    BandBlend(const ValueAndState<Part>& stretched, const Slow& slow, const Part& background)
        : background_(background) {
        bands_.stretched = stretched.value;
        bands_.wanted = slow;
        meet(stretched);
    }
    /// Adds a side that is background which the carve freed. It has no slow part.
    void add_nothing(double weight) { add({background_, false}, weight); }
    void add(const ValueAndState<Part>& side, const Slow& slow, double weight) {
        add(side, weight);
        bands_.add({slow, components(side.value)}, weight);
    }
    ValueAndState<Part> result() {
        bands_.faded = faded_.value();
        // Most of a box is empty.
        const bool empty = bands_.faded == background_ && bands_.stretched == background_;
        auto value = empty ? bands_.faded : bands_.value();
        if (!openvdb::math::isFinite(value)) value = bands_.faded;
        return {value, faded_.on(background_) || (any_ && !empty && value != background_)};
    }

private:
    void add(const ValueAndState<Part>& side, double weight) {
        faded_.add(side, weight);
        meet(side);
    }
    void meet(const ValueAndState<Part>& sample) {
        if constexpr (std::is_floating_point_v<Part>)
            bands_.highest = std::max(bands_.highest, std::abs(static_cast<double>(sample.value)));
        any_ = any_ || sample.on;
    }

    const Part background_;
    Blend<Part> faded_;
    TwoBands<Part> bands_{};
    bool any_ = false;  ///< whether a value was active
};

}  // namespace fluidcarve
