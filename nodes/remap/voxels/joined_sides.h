#pragma once

#include "nodes/remap/voxels/carve_block.h"
#include "nodes/seams/joins.h"

#include <openvdb/Types.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace fluidcarve {

/// The sides that points show under a map that is joined by fades (METHOD 10 "Joins"), one point after the other.
class JoinedSides {
public:
    /// Content that a point shows a part of.
    struct Side {
        openvdb::Vec3d at;  ///< lattice coordinates before the carve
        double weight;      ///< all weights sum to 1
        bool nothing;       ///< whether the carve frees it
    };

    /// @param map, block  must outlive this object; the block must hold the points
    JoinedSides(const CarveMap& map, const CarveBlock& block) : map_(map), block_(block) {}

    /// Finds the sides of a point.
    /// @param at  carved lattice coordinates
    void find(const openvdb::Vec3d& at);
    const std::vector<Side>& all() const { return sides_; }
    /// Where the slow part of the point comes from: lattice coordinates before the carve.
    const openvdb::Vec3d& stretched() const { return stretched_; }
    /// Whether the carve frees the point.
    bool freed() const { return sides_.size() == 1 && sides_.front().nothing; }
    /// Whether there is one side, and the slow part comes from there, too.
    bool rigid() const { return sides_.size() == 1 && !sides_.front().nothing && sides_.front().at == stretched_; }

private:
    /// The displacement by which a step squeezes or stretches, or moves whole vertices.
    double displacement(std::size_t step, const openvdb::Vec3d& at) const;

    const CarveMap& map_;
    const CarveBlock& block_;
    std::vector<Side> sides_, next_;
    std::vector<Joins::Side> of_step_;
    openvdb::Vec3d stretched_{0.0};
};

template <class Part>
inline constexpr std::size_t components_of = openvdb::VecTraits<Part>::IsVec ? 3 : 1;

/// How badly the slow part of a side fits what it should be: 0 up to where one has 0.85 of the other, 1 from where it has half of it or less. There an
/// outline would be cropped, or doubled.
inline double misfit(const std::array<double, 3>& shown, const std::array<double, 3>& wanted, std::size_t components) {
    constexpr double fits = 0.85, misfits = 0.5;
    double of_shown = 0, of_wanted = 0, both = 0;
    for (std::size_t c = 0; c < components; ++c) {
        of_shown += shown[c] * shown[c];
        of_wanted += wanted[c] * wanted[c];
        both += shown[c] * wanted[c];
    }
    const double most = std::max(of_shown, of_wanted);
    const double alike = most == 0 ? 1 : both <= 0 ? 0 : std::sqrt(std::min(of_shown, of_wanted) / most);
    const double x = std::clamp((fits - alike) / (fits - misfits), 0.0, 1.0);
    return x * x * (3 - 2 * x);
}

/// A value in two bands: the faded one, its slow part, and what it should be.
template <class Part>
struct TwoBands {
    Part faded, stretched;                    ///< the value where the slow part comes from
    std::array<double, 3> shown{}, wanted{};  ///< the faded slow part, and that where it comes from
    double stretch = 0;                       ///< share of the stretched value, by how badly the sides fit
    double squares = 0;                       ///< of the sides' weights, summed
    double highest = 0;                       ///< the greatest size of all values, if they are single numbers

    /// The faded detail upon the slow part that should be there.
    Part value() const {
        // A mean of details that do not match is flatter than they are. They match half.
        const double gain = 1 / std::sqrt(0.5 * (1 + squares));
        Part out = faded;
        for (std::size_t c = 0; c < components_of<Part>; ++c) {
            const double mean = get(faded, c), raised = shown[c] + (mean - shown[c]) * gain, value = raised * mean > 0 ? raised : 0;
            // What is dim stays dim: where nothing is shown, nothing is added.
            const double share = shown[c] == 0 ? 0 : std::clamp(value / shown[c], 0.0, 1.0);
            const bool lower = wanted[c] * shown[c] >= 0 && std::abs(wanted[c]) < std::abs(shown[c]);
            const double whole = lower ? value * wanted[c] / shown[c] : value + share * (wanted[c] - shown[c]);
            const double mixed = whole + stretch * (get(stretched, c) - whole);
            if constexpr (openvdb::VecTraits<Part>::IsVec) out[static_cast<int>(c)] = static_cast<typename openvdb::VecTraits<Part>::ElementType>(mixed);
            else out = static_cast<Part>(std::clamp(mixed, -highest, highest));
        }
        return out;
    }

private:
    static double get(const Part& value, std::size_t c) {
        if constexpr (openvdb::VecTraits<Part>::IsVec) return static_cast<double>(value[static_cast<int>(c)]);
        else return static_cast<void>(c), static_cast<double>(value);
    }
};

}  // namespace fluidcarve
