#include "carve/lattice/rig_extent.h"

#include <fmt/format.h>

namespace fluidcarve {

std::string to_text(const RigExtent& extent) {
    const auto* const unit = extent.percent ? "%" : "";
    return fmt::format("[{}{}, {}{}]", extent.low, unit, extent.high, unit);
}

}  // namespace fluidcarve
