#include "graph/text/base64.h"

#include <algorithm>
#include <cstdint>

namespace fluidcarve {

std::string base64(std::string_view bytes) {
    static constexpr const char* digits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t n = 0; n < bytes.size(); n += 3) {
        std::uint32_t three = 0;
        const auto count = std::min<std::size_t>(3, bytes.size() - n);
        for (std::size_t i = 0; i < 3; ++i)
            three = three << 8 | (i < count ? static_cast<unsigned char>(bytes[n + i]) : 0U);
        for (std::size_t i = 0; i < 4; ++i)
            out += i <= count ? digits[three >> (18 - 6 * i) & 63U] : '=';
    }
    return out;
}

}  // namespace fluidcarve
