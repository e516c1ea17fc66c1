#include "carve/base/one_line.h"

#include <fmt/format.h>

#include <algorithm>

namespace fluidcarve {

std::string one_line(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
    return text;
}

std::string printable(const std::string& text) {
    std::string out;
    for (std::size_t n = 0; n < text.size(); ++n) {
        const auto c = static_cast<unsigned char>(text[n]);
        // In UTF-8, 0xc2 begins the control characters from 0x80 to 0x9f.
        const bool upper =
            c == 0xc2 && n + 1 < text.size() && static_cast<unsigned char>(text[n + 1]) < 0xa0;
        if ((c < 0x20 && c != '\n' && c != '\t') || c == 0x7f) out += fmt::format("\\x{:02x}", c);
        else if (upper) out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[++n]));
        else out += text[n];
    }
    return out;
}

std::string cut_short(const std::string& text) {
    constexpr std::size_t most = 60;
    if (text.size() <= most) return text;
    const auto begins_inside = [&](std::size_t at) {
        return (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80;
    };
    constexpr std::size_t longest_character = 4;
    auto end = most;
    while (end > most - longest_character && begins_inside(end)) --end;
    if (begins_inside(end)) end = most;  // the text is not UTF-8
    return text.substr(0, end) + "...";
}

}  // namespace fluidcarve
