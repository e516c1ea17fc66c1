#include "graph/text/words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

namespace fluidcarve {

std::string three_digits(double value) { return fmt::format("{:.{}f}", value, value < 9.995 ? 2 : value < 99.95 ? 1 : 0); }

std::string duration_text(double seconds) {
    if (seconds < 0.0995) return three_digits(seconds * 1e3) + " ms";
    if (seconds < 100) return three_digits(seconds) + " s";
    return seconds < 6000 ? three_digits(seconds / 60) + " min" : three_digits(seconds / 3600) + " h";
}

std::string size_text(std::uint64_t bytes) {
    const auto value = static_cast<double>(bytes);
    if (bytes < 1000) return fmt::format("{} B", bytes);
    return value < 1e6 ? three_digits(value * 1e-3) + " kB" : value < 1e9 ? three_digits(value * 1e-6) + " MB" : three_digits(value * 1e-9) + " GB";
}

std::string counted(std::size_t count, std::string_view what) { return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s"); }

std::string either(const std::vector<std::string>& all) {
    if (all.size() == 1) return all[0];
    return fmt::format("{} or {}", fmt::join(all.begin(), all.end() - 1, ", "), all.back());
}

std::string in_small_letters(std::string_view text) {
    std::string out(text);
    for (auto& letter : out)
        if (letter >= 'A' && letter <= 'Z') letter += 'a' - 'A';
    return out;
}

std::string ending_of(std::string_view path) { return in_small_letters(std::filesystem::path(path).extension().string()); }

}  // namespace fluidcarve
