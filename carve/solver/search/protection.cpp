#include "carve/solver/search/protection.h"

namespace fluidcarve {

std::vector<std::uint16_t> past_protected(const EnergyVolume& energy, Window window,
                                          std::vector<std::uint16_t> seam) {
    if (!energy.protects() || energy.met(seam).blocked == 0) return seam;
    const Columns columns(energy);
    return with_costs(energy, [&](const auto& cost_at) {
        return moved_aside(columns, seam, Band::whole(columns.count(), window), cost_at,
                           energy.steps());
    });
}

}  // namespace fluidcarve
