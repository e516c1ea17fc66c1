#include "carve/solver/greedy_guide.h"

namespace fluidcarve {

GuideTable gaussians(int slices, double height) {
    GuideTable out(static_cast<std::size_t>(slices));
    for (int k = 1; k < slices; ++k)
        for (int distance = 0; distance <= slices - k; ++distance) {
            const double widths = 2.0 * distance / (slices - k);
            out[static_cast<std::size_t>(k)].push_back(
                static_cast<float>(height * (1 - std::exp(-0.5 * widths * widths))));
        }
    return out;
}

}  // namespace fluidcarve
