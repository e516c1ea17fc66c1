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

/// Gives a faded value the slow part that it should have.
/// @param stretched  the value where the slow part comes from
/// @param wanted     the slow part there
/// @param shown      the faded slow part
/// @param highest    of a single number, the result's greatest size
template <class Part>
Part with_slow_part(const Part& faded, const Part& stretched, const std::array<double, 3>& wanted, const std::array<double, 3>& shown, double highest) {
    const auto get = [](const Part& value, std::size_t c) {
        if constexpr (openvdb::VecTraits<Part>::IsVec) return static_cast<double>(value[static_cast<int>(c)]);
        else return static_cast<void>(c), static_cast<double>(value);
    };
    // Where the slow parts differ, an outline would be cropped, or doubled: there content is only squeezed or stretched.
    double apart = 0, size = 0;
    for (std::size_t c = 0; c < components_of<Part>; ++c) {
        apart += (wanted[c] - shown[c]) * (wanted[c] - shown[c]);
        size += (wanted[c] + shown[c]) * (wanted[c] + shown[c]);
    }
    constexpr double fits = 0.1, misfits = 0.4;
    const double misfit = size == 0 ? 0 : std::clamp((2 * std::sqrt(apart / size) - fits) / (misfits - fits), 0.0, 1.0);
    const double stretch = misfit * misfit * (3 - 2 * misfit);
    Part out = faded;
    for (std::size_t c = 0; c < components_of<Part>; ++c) {
        const double value = get(faded, c);
        // What is dim stays dim: where nothing is shown, nothing is added.
        const double share = shown[c] == 0 ? 0 : std::clamp(value / shown[c], 0.0, 1.0);
        const double whole = value + share * (wanted[c] - shown[c]), mixed = whole + stretch * (get(stretched, c) - whole);
        if constexpr (openvdb::VecTraits<Part>::IsVec) out[static_cast<int>(c)] = static_cast<typename openvdb::VecTraits<Part>::ElementType>(mixed);
        else out = static_cast<Part>(std::clamp(mixed, -highest, highest));
    }
    return out;
}

}  // namespace fluidcarve
