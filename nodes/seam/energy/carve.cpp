#include "nodes/seam/energy/carve.h"

#include "nodes/seam/energy/code.h"

#include <tbb/parallel_for.h>

namespace fluidcarve {

namespace {

/// Strides between the vertices of a frame along u, v and w.
struct Places {
    std::array<std::size_t, 3> stride;

    Places(const std::array<int, 3>& shape, Axis axis) {
        const auto u = static_cast<std::size_t>(shape[0]), v = static_cast<std::size_t>(shape[1]);
        stride = axis == Axis::u ? std::array{std::size_t{1}, u, u * v} : std::array{v, std::size_t{1}, u * v};
    }
};

std::uint16_t mean_energy(std::uint16_t a, std::uint16_t b) {
    for (const auto mark : {protected_code, attracted_code})
        if (a == mark || b == mark) return mark;
    return encode_energy(0.5f * (decode_energy(a) + decode_energy(b)));
}

std::uint16_t mean_field(std::uint16_t a, std::uint16_t b) { return encode_field(0.5f * (decode_field(a) + decode_field(b))); }

template <class Mean>
std::vector<std::uint16_t> carve(const std::vector<std::uint16_t>& from, const Places& before, const Places& after, std::size_t size, const CarveStep& step,
                                 const Mean& mean) {
    std::vector<std::uint16_t> out(size);
    const auto along = static_cast<std::size_t>(step.axis()), across = static_cast<std::size_t>(step.lateral_axis());
    tbb::parallel_for(0, step.slices(), [&](int k) {
        for (int lateral = 0; lateral < step.laterals(); ++lateral) {
            const auto column = [&](const Places& places) {
                return places.stride[2] * static_cast<std::size_t>(k) + places.stride[across] * static_cast<std::size_t>(lateral);
            };
            const auto* const source = from.data() + column(before);
            auto* target = out.data() + column(after);
            const auto bounds = step.bounds(step.first_lateral() + lateral, k);
            std::size_t passed = 0;
            for (int entry = step.start(); entry <= step.last(); ++entry, target += after.stride[along]) {
                while (passed < bounds.size() && bounds[passed] <= entry) ++passed;
                const int twice = 2 * (entry - step.origin()) + step.displacement(entry, passed, bounds);
                const auto* const low = source + before.stride[along] * static_cast<std::size_t>(twice / 2);
                *target = twice % 2 == 0 ? *low : mean(*low, low[before.stride[along]]);
            }
        }
    });
    return out;
}

template <class Mean>
std::vector<std::uint16_t> carve(std::vector<std::uint16_t> codes, std::array<int, 3> shape, Axis axis, std::span<const CarveStep> steps, const Mean& mean) {
    for (const auto& step : steps) {
        const Places before(shape, axis);
        shape[static_cast<std::size_t>(step.axis())] = step.after();
        const auto size = static_cast<std::size_t>(shape[0]) * static_cast<std::size_t>(shape[1]) * static_cast<std::size_t>(shape[2]);
        codes = carve(codes, before, Places(shape, axis), size, step, mean);
    }
    return codes;
}

}  // namespace

std::vector<std::uint16_t> carve_energy(std::vector<std::uint16_t> codes, const std::array<int, 3>& shape, Axis axis, std::span<const CarveStep> steps) {
    return carve(std::move(codes), shape, axis, steps, mean_energy);
}

std::vector<std::uint16_t> carve_field(std::vector<std::uint16_t> codes, const std::array<int, 3>& shape, Axis axis, std::span<const CarveStep> steps) {
    return carve(std::move(codes), shape, axis, steps, mean_field);
}

}  // namespace fluidcarve
