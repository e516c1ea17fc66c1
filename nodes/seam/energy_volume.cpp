#include "nodes/seam/energy_volume.h"

#include <tbb/parallel_for.h>

#include <cstring>

namespace fluidcarve {

EnergyVolume::EnergyVolume(const std::array<int, 3>& shape, Axis axis, std::size_t frames, std::uint64_t memory_budget, const std::string& folder)
    : width_(shape[axis == Axis::u ? 0 : 1]),
      laterals_(shape[axis == Axis::u ? 1 : 0]),
      slices_(shape[2]),
      stride_(static_cast<std::size_t>(width_)),
      slabs_(frames, stride_ * columns_per_frame(), memory_budget, folder) {}

void EnergyVolume::remove(std::span<const std::uint16_t> at) {
    const auto columns = columns_per_frame();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, columns * frames(), 4096), [&](const tbb::blocked_range<std::size_t>& range) {
        for (auto c = range.begin(); c < range.end(); ++c) {
            auto* const entry = slab(c / columns).data() + c % columns * stride_ + at[c];
            std::memmove(entry, entry + 1, (static_cast<std::size_t>(width_) - at[c] - 1) * sizeof(*entry));
        }
    });
    --width_;
}

}  // namespace fluidcarve
