#include "graph/text/problem.h"

#include "carve/base/one_line.h"
#include "graph/text/json_text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
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

nlohmann::ordered_json to_json(const Mark& mark, const std::string& message) {
    return {{"file", mark.source ? mark.source->name : ""},
            {"line", mark.line},
            {"column", mark.column},
            {"message", message}};
}

/// Sorted by place, without duplicates.
Problems ordered(Problems problems) {
    const auto key = [](const Problem& problem) {
        return std::tuple(
            problem.at.source ? std::string_view(problem.at.source->name) : std::string_view(),
            problem.at.line, problem.at.column);
    };
    std::ranges::stable_sort(problems,
                             [&](const Problem& a, const Problem& b) { return key(a) < key(b); });
    const auto same = [&](const Problem& a, const Problem& b) {
        return key(a) == key(b) && a.message == b.message && a.also == b.also;
    };
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

nlohmann::ordered_json to_json(const Problems& problems) {
    auto out = nlohmann::ordered_json::array();
    for (const auto& problem : ordered(problems)) {
        auto entry = to_json(problem.at, problem.message);
        if (!problem.also.empty()) entry["also"] = to_json(problem.also_at, problem.also);
        out.push_back(std::move(entry));
    }
    return out;
}

}  // namespace fluidcarve
