#include "carve/base/words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <utility>

namespace fluidcarve {

namespace {

/// A number for people, rounded to three significant digits; whole from 100 on.
std::string three_digits(double value) {
    return fmt::format("{:.{}f}", value, value < 9.995 ? 2 : value < 99.95 ? 1 : 0);
}

}  // namespace

std::string duration_text(double seconds) {
    if (seconds < 0.0995) return three_digits(seconds * 1e3) + " ms";
    if (seconds < 100) return three_digits(seconds) + " s";
    return seconds < 6000 ? three_digits(seconds / 60) + " min"
                          : three_digits(seconds / 3600) + " h";
}

std::string size_text(std::uint64_t bytes) {
    const auto value = static_cast<double>(bytes);
    if (bytes < 1000) return fmt::format("{} B", bytes);
    return value < 1e6   ? three_digits(value * 1e-3) + " kB"
           : value < 1e9 ? three_digits(value * 1e-6) + " MB"
                         : three_digits(value * 1e-9) + " GB";
}

std::string counted(std::size_t count, std::string_view what) {
    return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string numbers_text(const std::array<double, 3>& of) {
    return fmt::format("{:g}, {:g}, {:g}", of[0], of[1], of[2]);
}

std::string numbers_text(const std::array<int, 3>& of) {
    return fmt::format("{}, {}, {}", of[0], of[1], of[2]);
}

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

std::string ending_of(std::string_view path) {
    return in_small_letters(std::filesystem::path(path).extension().string());
}

std::string nearest(std::string_view name, const std::vector<std::string>& candidates) {
    // A swap of two neighbouring letters counts as one edit.
    const auto distance = [](std::string_view a, std::string_view b) {
        std::vector<std::size_t> before(b.size() + 1), row(b.size() + 1), next(b.size() + 1);
        std::iota(row.begin(), row.end(), std::size_t{0});
        for (std::size_t i = 0; i < a.size(); ++i) {
            next[0] = i + 1;
            for (std::size_t j = 0; j < b.size(); ++j) {
                next[j + 1] =
                    std::min({row[j + 1] + 1, next[j] + 1, row[j] + (a[i] == b[j] ? 0 : 1)});
                if (i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j])
                    next[j + 1] = std::min(next[j + 1], before[j - 1] + 1);
            }
            std::swap(before, row);
            std::swap(row, next);
        }
        return row[b.size()];
    };
    if (name.size() > 100 || candidates.size() > 1000) return {};
    std::string best;
    auto least = std::max<std::size_t>(1, name.size() / 3) + 1;
    for (const auto& candidate : candidates) {
        const auto d = distance(name, candidate);
        // If every letter changes, the candidate is a different name.
        if (d < least && d < name.size()) {
            least = d;
            best = candidate;
        }
    }
    return best;
}

std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates) {
    if (const auto best = nearest(name, candidates); !best.empty())
        return fmt::format("; did you mean '{}'?", best);
    if (candidates.empty()) return {};
    constexpr std::size_t most = 12;
    if (candidates.size() <= most) return fmt::format("; known: {}", fmt::join(candidates, ", "));
    return fmt::format("; known: {} and {} more",
                       fmt::join(candidates.begin(), candidates.begin() + most, ", "),
                       candidates.size() - most);
}

}  // namespace fluidcarve
