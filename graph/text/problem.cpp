#include "graph/text/problem.h"

#include "graph/text/json_text.h"
#include "graph/text/one_line.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <numeric>
#include <tuple>

namespace fluidcarve {
namespace {

std::string line_of(const Mark& mark) {
    const auto& text = mark.source->text;
    std::size_t begin = 0;
    for (int line = 1; line < mark.line && begin != std::string::npos; ++line) {
        begin = text.find('\n', begin);
        if (begin != std::string::npos) ++begin;
    }
    if (begin == std::string::npos || begin >= text.size()) return {};
    auto line = text.substr(begin, text.find('\n', begin) - begin);
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return one_line(line);
}

void put(std::string& out, const Mark& mark, const std::string& message) {
    if (mark.source) out += mark.source->name + ":";
    if (mark.source && mark.line > 0) out += fmt::format("{}:{}:", mark.line, mark.column);
    out += (out.empty() || out.back() == '\n' ? "" : " ") + one_line(message) + "\n";
    if (!mark.source || mark.line == 0) return;
    // Show only the part of a long line around the caret.
    constexpr std::size_t widest = 160;
    auto line = line_of(mark);
    if (line.empty()) return;
    auto column = static_cast<std::size_t>(std::max(mark.column - 1, 0));
    if (line.size() > widest) {
        const auto begin = column > widest / 2 ? column - widest / 2 : 0;
        line = line.substr(std::min(begin, line.size()), widest);
        column -= begin;
    }
    out += fmt::format("{}\n{:>{}}\n", line, "^", column + 1);
}

nlohmann::ordered_json json_of(const Mark& mark, const std::string& message) {
    return {{"file", mark.source ? mark.source->name : ""}, {"line", mark.line}, {"column", mark.column}, {"message", message}};
}

/// Sorted by place, without duplicates.
Problems ordered(Problems problems) {
    const auto key = [](const Problem& problem) {
        return std::tuple(problem.at.source ? std::string_view(problem.at.source->name) : std::string_view(), problem.at.line, problem.at.column);
    };
    std::stable_sort(problems.begin(), problems.end(), [&](const Problem& a, const Problem& b) { return key(a) < key(b); });
    const auto same = [&](const Problem& a, const Problem& b) { return key(a) == key(b) && a.message == b.message && a.also == b.also; };
    problems.erase(std::unique(problems.begin(), problems.end(), same), problems.end());
    return problems;
}

}  // namespace

std::string to_text(const Problem& problem) {
    std::string out;
    put(out, problem.at, problem.message);
    if (!problem.also.empty()) put(out, problem.also_at, problem.also);
    return out;
}

std::string to_text(const Problems& problems) {
    constexpr std::size_t most = 100;
    const auto all = ordered(problems);
    std::string out;
    for (std::size_t n = 0; n < std::min(most, all.size()); ++n) out += to_text(all[n]);
    if (all.size() > most) out += fmt::format("... and {} more problems\n", all.size() - most);
    return out;
}

std::string to_json(const Problems& problems) {
    auto out = nlohmann::ordered_json::array();
    for (const auto& problem : ordered(problems)) {
        auto entry = json_of(problem.at, problem.message);
        if (!problem.also.empty()) entry["also"] = json_of(problem.also_at, problem.also);
        out.push_back(std::move(entry));
    }
    return json_text(out, 2) + "\n";
}

std::string nearest(std::string_view name, const std::vector<std::string>& candidates) {
    // A swap of two neighbouring letters counts as one edit.
    const auto distance = [](std::string_view a, std::string_view b) {
        std::vector<std::size_t> before(b.size() + 1), row(b.size() + 1), next(b.size() + 1);
        std::iota(row.begin(), row.end(), std::size_t{0});
        for (std::size_t i = 0; i < a.size(); ++i) {
            next[0] = i + 1;
            for (std::size_t j = 0; j < b.size(); ++j) {
                next[j + 1] = std::min({row[j + 1] + 1, next[j] + 1, row[j] + (a[i] == b[j] ? 0 : 1)});
                if (i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j]) next[j + 1] = std::min(next[j + 1], before[j - 1] + 1);
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
        // If every letter of the name changes, it is another name.
        if (d < least && d < name.size()) {
            least = d;
            best = candidate;
        }
    }
    return best;
}

std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates) {
    if (const auto best = nearest(name, candidates); !best.empty()) return fmt::format("; did you mean '{}'?", best);
    if (candidates.empty()) return {};
    constexpr std::size_t most = 12;
    if (candidates.size() <= most) return fmt::format("; known: {}", fmt::join(candidates, ", "));
    return fmt::format("; known: {} and {} more", fmt::join(candidates.begin(), candidates.begin() + most, ", "), candidates.size() - most);
}

}  // namespace fluidcarve
