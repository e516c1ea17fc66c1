#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace fluidcarve {

/// Values at the vertices of one plane of a lattice, rows along the carved axis.
struct PlaneSamples {
    int width = 0;              ///< vertices along the axis
    int rows = 0;               ///< vertices along the lateral axis
    std::vector<float> values;  ///< `[lateral][u]`

    PlaneSamples(int width, int rows)
        : width(width),
          rows(rows),
          values(static_cast<std::size_t>(width) * static_cast<std::size_t>(rows)) {}
    float* row(int lateral) {
        return values.data() + static_cast<std::size_t>(lateral) * static_cast<std::size_t>(width);
    }
    const float* row(int lateral) const {
        return values.data() + static_cast<std::size_t>(lateral) * static_cast<std::size_t>(width);
    }
};

/// Sum of the squared distances of patches, and the number of patches.
struct PatchSum {
    double squares = 0;
    std::size_t patches = 0;
    PatchSum& operator+=(const PatchSum& other);
    double root_mean() const {
        return patches > 0 ? std::sqrt(squares / static_cast<double>(patches)) : 0;
    }
};

/// Compares each patch of a plane with the nearest patch of another one (METHOD 11 "Seams or a
/// warp"): a patch has 9 x 9 vertices, and the nearest one is sought at the same lateral place.
/// Patches that are mostly empty do not count.
/// @param of, among  with the same number of rows
/// @param visible    values below this are empty space
/// @param moved      vertices by which content may have moved along the axis
PatchSum nearest_patches(const PlaneSamples& of, const PlaneSamples& among, float visible,
                         int moved);

}  // namespace fluidcarve
