#pragma once

#include "carve/remap/voxels/carve_block.h"
#include "carve/seam/joins.h"

#include <openvdb/Types.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace fluidcarve {

/// The sources that are blended at a point under a map whose seams are joined by fades (METHOD 10
/// "Joins"). Holds one point at a time.
class JoinedSides {
public:
    /// One of the blended sources.
    struct Side {
        openvdb::Vec3d at;  ///< lattice coordinates before the carve
        double weight;      ///< all weights sum to 1
        bool nothing;       ///< whether it is background that the carve freed
    };

    /// @param map, block  must outlive this object; the block must hold the points
    JoinedSides(const CarveMap& map, const CarveBlock& block) : map_(map), block_(block) {}

    /// Finds the sides of a point.
    /// @param at  carved lattice coordinates
    void find(const openvdb::Vec3d& at);
    const std::vector<Side>& all() const { return sides_; }
    /// Source of the point's slow part: lattice coordinates before the carve.
    const openvdb::Vec3d& stretched() const { return stretched_; }
    /// Whether the carve frees the point.
    bool freed() const { return sides_.size() == 1 && sides_.front().nothing; }
    /// Whether there is only one side, which is also the source of the slow part.
    bool rigid() const {
        return sides_.size() == 1 && !sides_.front().nothing && sides_.front().at == stretched_;
    }

private:
    /// A step's displacement: smoothed if it is soft, else by whole vertices.
    double displacement(std::size_t step, const openvdb::Vec3d& at) const;

    const CarveMap& map_;
    const CarveBlock& block_;
    std::vector<Side> sides_, next_;
    std::vector<Joins::Side> of_step_;
    openvdb::Vec3d stretched_{0.0};
};

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

}  // namespace fluidcarve
