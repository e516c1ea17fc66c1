#include "carve/solver/search/bound_column.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>

namespace fluidcarve {

namespace {

using EightBits = std::uint32_t __attribute__((vector_size(32)));
using EightCodes = std::uint16_t __attribute__((vector_size(16)));

constexpr auto infinity = std::numeric_limits<float>::infinity();

FLUIDCARVE_INLINE Eight eight_from_upper(const std::uint16_t* codes) {
    EightCodes eight;
    std::memcpy(&eight, codes, sizeof eight);
    return std::bit_cast<Eight>(__builtin_convertvector(eight, EightBits) << 16);
}

FLUIDCARVE_INLINE void keep_upper(Eight values, std::uint16_t* codes) {
    const auto eight = __builtin_convertvector(std::bit_cast<EightBits>(values) >> 16, EightCodes);
    std::memcpy(codes, &eight, sizeof eight);
}

template <bool edges>
FLUIDCARVE_INLINE void send(const float* part, const float* here, const float* there,
                            const StepPrice& price, float least_part, std::size_t width,
                            float* message) {
    const auto weight = eight_of(price.weight), left_out = eight_of(least_part);
    for (std::size_t i = 0; i < width; i += 8) {
        auto rise = eight_at(part + i - 1), fall = eight_at(part + i + 1);
        if constexpr (edges) {
            const auto from = eight_at(here + i), above = eight_at(there + i - 1),
                       below = eight_at(there + i + 1);
            rise += price.rigid(from, above) + weight * absolute(above - from);
            fall += price.rigid(from, below) + weight * absolute(from - below);
        }
        auto beside = least(rise, fall);
        if constexpr (!edges) beside += eight_of(price.rigidity);
        const auto out = least(eight_at(part + i), beside) - left_out;
        std::memcpy(message + i, &out, sizeof out);
    }
}

FLUIDCARVE_WIDE void send_with_edges(const float* part, const float* here, const float* there,
                                     const StepPrice& price, float least_part, std::size_t width,
                                     float* message) {
    send<true>(part, here, there, price, least_part, width, message);
}

FLUIDCARVE_WIDE void send_with_steps(const float* part, const StepPrice& price, float least_part,
                                     std::size_t width, float* message) {
    send<false>(part, nullptr, nullptr, price, least_part, width, message);
}

}  // namespace

FLUIDCARVE_WIDE void divide_column(std::span<ColumnLine> lines, const float* costs,
                                   std::size_t width, float share) {
    std::array<Eight, 3> smallest{eight_of(infinity), eight_of(infinity), eight_of(infinity)};
    for (std::size_t i = 0; i < width; i += 8) {
        auto sum = eight_at(costs + i);
        for (auto& line : lines) {
            const auto front = eight_at(line.front + i);
            const auto ahead =
                line.read_ahead ? eight_from_upper(line.kept + i) : eight_at(line.ahead + i);
            if (line.read_ahead) std::memcpy(line.ahead + i, &ahead, sizeof ahead);
            if (line.keep_front) keep_upper(front, line.kept + i);
            sum += front + ahead;
        }
        sum *= share;
        const auto are_entries = eight_places < static_cast<std::int32_t>(width - i);
        for (std::size_t n = 0; n < lines.size(); ++n) {
            // Where no seam can pass, both may be infinite.
            auto part = sum == infinity ? sum : sum - eight_at(lines[n].ahead + i);
            part = are_entries ? part : eight_of(infinity);
            smallest[n] = least(smallest[n], part);
            std::memcpy(lines[n].part + i, &part, sizeof part);
        }
    }
    for (std::size_t n = 0; n < lines.size(); ++n) {
        lines[n].least = smallest[n][0];
        for (int lane = 1; lane < 8; ++lane)
            lines[n].least = std::min(lines[n].least, smallest[n][lane]);
    }
}

void send_to_column(float* part, const float* here, const float* there, const StepPrice& price,
                    float least, std::size_t width, float* message) {
    part[-1] = part[whole_eights(width)] = infinity;
    if (here) send_with_edges(part, here, there, price, least, width, message);
    else send_with_steps(part, price, least, width, message);
}

}  // namespace fluidcarve
