#include "carve/solver/costs/carve.h"

#include "carve/solver/costs/code.h"
#include "carve/solver/costs/half.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace fluidcarve {

namespace {

/// Strides between the vertices of a frame along u, v and w.
struct Places {
    std::array<std::size_t, 3> stride;

    Places(const std::array<int, 3>& shape, Axis axis) {
        const auto entries = static_cast<std::size_t>(shape[dimension(axis)]),
                   laterals = static_cast<std::size_t>(shape[lateral_dimension(axis)]);
        stride = vertex_of(axis, std::size_t{1}, entries, entries * laterals);
    }
};

// Both interpolate between two codes. @param part  weight of the second one, above 0
std::uint16_t mixed_energy(std::uint16_t a, std::uint16_t b, float part) {
    for (const auto mark : {protected_code, attracted_code})
        if (a == mark || b == mark) return mark;
    return encode_energy((1 - part) * decode_energy(a) + part * decode_energy(b));
}

std::uint16_t mixed_field(std::uint16_t a, std::uint16_t b, float part) {
    return encode_field((1 - part) * decode_field(a) + part * decode_field(b));
}

/// Calls `visit(from, part)` for each entry of a column after the carve: its content is that of
/// entry `from`, mixed with the share `part` of the next.
template <class Visit>
void each_seam_source(const CarveStep& step, int lateral, int slice, const Visit& visit) {
    const auto bounds = step.first_displaced(lateral, slice);
    std::size_t passed = 0;
    for (int entry = step.start(); entry <= step.last(); ++entry) {
        while (passed < bounds.size() && bounds[passed] <= entry) ++passed;
        const int twice = 2 * (entry - step.origin()) + step.displacement(entry, passed, bounds);
        visit(twice / 2, twice % 2 == 0 ? 0.0f : 0.5f);
    }
}

/// The same for a warp. `from` is -1 where there is no content.
template <class Visit>
void each_warp_source(const CarveStep& step, int lateral, int slice, const Visit& visit) {
    const auto [begin, end] = step.ends(
        openvdb::Vec3d(vertex_of<double>(static_cast<Axis>(step.axis()), 0, lateral, slice).data()),
        1);
    for (int entry = step.start(); entry <= step.last(); ++entry) {
        if (entry < begin || entry > end) {
            visit(-1, 0.0f);
            continue;
        }
        const double source =
            step.clamped(entry + static_cast<double>(step.soft()->entry(entry, lateral, slice))) -
            step.origin();
        const int from = static_cast<int>(source);
        visit(from, static_cast<float>(source - from));
    }
}

template <class Mix>
std::vector<std::uint16_t> carve(const std::vector<std::uint16_t>& from, const Places& before,
                                 const Places& after, std::size_t size, const CarveStep& step,
                                 int finest, const Mix& mix) {
    std::vector<std::uint16_t> out(size);
    const auto along = static_cast<std::size_t>(step.axis()),
               across = static_cast<std::size_t>(step.lateral_axis()),
               last = static_cast<std::size_t>(step.slice_axis());
    const std::uint16_t nothing = 0;
    const auto [slices, laterals, unused] =
        gathered_shape({step.columns().slices, step.columns().laterals, 0}, finest);
    tbb::parallel_for(0, slices, [&, laterals = laterals](int k) {
        for (int lateral = 0; lateral < laterals; ++lateral) {
            const auto column = [&](const Places& places) {
                return places.stride[last] * static_cast<std::size_t>(k) +
                       places.stride[across] * static_cast<std::size_t>(lateral);
            };
            const auto* const source = from.data() + column(before);
            auto* target = out.data() + column(after);
            int entries = 0;
            const auto set = [&](int entry, float part) {
                // A coarse entry moves as the first of its vertices.
                if (entries++ % finest != 0) return;
                if (finest > 1) {
                    entry = entry < 0 ? -1 : entry / finest;
                    part = 0;
                }
                const auto* const low =
                    source + before.stride[along] * static_cast<std::size_t>(std::max(entry, 0));
                *target = entry < 0   ? nothing
                          : part == 0 ? *low
                                      : mix(*low, low[before.stride[along]], part);
                target += after.stride[along];
            };
            const int fine_lateral = step.columns().first_lateral + finest * lateral,
                      fine_slice = step.columns().first_slice + finest * k;
            if (step.warps()) each_warp_source(step, fine_lateral, fine_slice, set);
            else each_seam_source(step, fine_lateral, fine_slice, set);
        }
    });
    return out;
}

template <class Mix>
std::vector<std::uint16_t> carve(std::vector<std::uint16_t> codes, std::array<int, 3> shape,
                                 Axis axis, std::span<const CarveStep> steps, int finest,
                                 const Mix& mix) {
    for (const auto& step : steps) {
        const Places before(gathered_shape(shape, finest), axis);
        shape[static_cast<std::size_t>(step.axis())] = step.after();
        const auto now = gathered_shape(shape, finest);
        const auto size = static_cast<std::size_t>(now[0]) * static_cast<std::size_t>(now[1]) *
                          static_cast<std::size_t>(now[2]);
        codes = carve(codes, before, Places(now, axis), size, step, finest, mix);
    }
    return codes;
}

}  // namespace

std::vector<std::uint16_t> carve_energy(std::vector<std::uint16_t> codes,
                                        const std::array<int, 3>& shape, Axis axis,
                                        std::span<const CarveStep> steps, int finest) {
    return carve(std::move(codes), shape, axis, steps, finest, mixed_energy);
}

std::vector<std::uint16_t> carve_field(std::vector<std::uint16_t> codes,
                                       const std::array<int, 3>& shape, Axis axis,
                                       std::span<const CarveStep> steps, int finest) {
    return carve(std::move(codes), shape, axis, steps, finest, mixed_field);
}

}  // namespace fluidcarve
