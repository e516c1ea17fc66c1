#include "nodes/seam/energy_volume.h"

#include "nodes/seam/energy_code.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <cstring>
#include <functional>

namespace fluidcarve {

using ColumnRange = tbb::blocked_range<std::size_t>;

EnergyVolume::EnergyVolume(const std::array<int, 3>& shape, Axis axis, std::size_t frames, std::uint64_t memory_budget, const std::string& folder, bool closed)
    : width_(shape[axis == Axis::u ? 0 : 1]),
      laterals_(shape[axis == Axis::u ? 1 : 0]),
      slices_(shape[2]),
      stride_(static_cast<std::size_t>(width_)),
      closed_(closed),
      slabs_(frames, stride_ * columns_per_frame(), memory_budget, folder) {}

EnergyVolume::EnergyVolume(const EnergyVolume& whole, std::vector<float> sums)
    : width_(whole.width_),
      laterals_(whole.laterals_),
      slices_(whole.slices_),
      stride_(whole.stride_),
      closed_(whole.closed_),
      slabs_(1, 0, 0, ""),
      sums_(std::move(sums)) {}

EnergyVolume EnergyVolume::sum() const {
    std::vector<float> sums(stride_ * columns_per_frame());
    tbb::parallel_for(ColumnRange(0, sums.size(), 4096), [&](const ColumnRange& range) {
        std::vector<double> part(range.size(), 0.0);
        for (std::size_t t = 0; t < frames(); ++t)
            for (std::size_t n = 0; n < part.size(); ++n) part[n] += decode_energy(slab(t)[range.begin() + n]);
        for (std::size_t n = 0; n < part.size(); ++n) sums[range.begin() + n] = static_cast<float>(part[n]);
    });
    return {*this, std::move(sums)};
}

void EnergyVolume::remove(std::span<const std::uint16_t> at) {
    const auto columns = columns_per_frame();
    const auto close = [&](auto* column, std::size_t entry) {
        std::memmove(column + entry, column + entry + 1, (static_cast<std::size_t>(width_) - entry - 1) * sizeof(*column));
    };
    tbb::parallel_for(ColumnRange(0, columns * frames(), 4096), [&](const ColumnRange& range) {
        for (auto c = range.begin(); c < range.end(); ++c) {
            if (summed()) close(sums_.data() + c * stride_, at[c]);
            else close(slab(c / columns).data() + c % columns * stride_, at[c]);
        }
    });
    --width_;
}

std::size_t EnergyVolume::zeros(std::span<const std::uint16_t> at) const {
    const auto columns = columns_per_frame();
    return tbb::parallel_reduce(
        ColumnRange(0, columns * frames(), 4096), std::size_t{0},
        [&](const ColumnRange& range, std::size_t count) {
            for (auto c = range.begin(); c < range.end(); ++c)
                count += summed() ? sums_[c * stride_ + at[c]] == 0 : slab(c / columns)[c % columns * stride_ + at[c]] == 0;
            return count;
        },
        std::plus<>());
}

}  // namespace fluidcarve
