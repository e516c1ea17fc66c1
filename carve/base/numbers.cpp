#include "carve/base/numbers.h"

#include "carve/base/saturated.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace fluidcarve {

std::size_t bytes_of(NumberType type) {
    return with_number_type(type, [](auto value) { return sizeof value; });
}

bool is_floating(NumberType type) {
    return type == NumberType::float32 || type == NumberType::float64;
}

double full_intensity(NumberType type) {
    return is_floating(type) ? 1 : with_number_type(type, [](auto zero) {
        return static_cast<double>(std::numeric_limits<decltype(zero)>::max());
    });
}

double number_in(const char* bytes, NumberType type, bool swap) {
    return with_number_type(type, [&](auto value) {
        std::array<char, sizeof value> copy;
        std::memcpy(copy.data(), bytes, sizeof value);
        if (swap) std::ranges::reverse(copy);
        return static_cast<double>(std::bit_cast<decltype(value)>(copy));
    });
}

void put_number(std::string& out, double number, NumberType type, bool swap) {
    with_number_type(type, [&](auto value) {
        using T = decltype(value);
        if constexpr (std::is_integral_v<T>) value = saturated<T>(number);
        else value = static_cast<T>(number);
        auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
        if (swap) std::ranges::reverse(bytes);
        out.append(bytes.data(), bytes.size());
    });
}

bool is_swapped(NumberForm encoding) {
    return encoding ==
           (std::endian::native == std::endian::little ? NumberForm::big : NumberForm::little);
}

}  // namespace fluidcarve
