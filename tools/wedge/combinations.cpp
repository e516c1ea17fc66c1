#include "tools/wedge/combinations.h"

#include "carve/base/failure.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <string_view>

namespace fluidcarve {
namespace {

/// Splits at commas that stand in no brackets, braces or quotes.
std::vector<std::string> split(std::string_view text) {
    std::vector<std::string> out(1);
    int depth = 0;
    char quote = 0;
    for (const char c : text) {
        if (quote != 0) quote = c == quote ? '\0' : quote;
        else if (c == '"' || c == '\'') quote = c;
        else if (c == '[' || c == '{') ++depth;
        else if (c == ']' || c == '}') --depth;
        if (c == ',' && depth == 0 && quote == 0) out.emplace_back();
        else out.back() += c;
    }
    return out;
}

Varied varied_of(const std::string& text) {
    const auto sign = text.find('=');
    if (sign == std::string::npos || sign == 0)
        throw Failure(
            fmt::format("--over must be PARAM=VALUE,VALUE or NODE.FIELD=VALUE,VALUE, such as "
                        "count=-4,-8,-12, not '{}'",
                        text));
    Varied out{text.substr(0, sign), split(std::string_view(text).substr(sign + 1))};
    for (std::size_t n = 0; n < out.values.size(); ++n) {
        if (out.values[n].empty())
            throw Failure(fmt::format("--over {}: value {} of {} is empty; write {}=VALUE,VALUE",
                                      out.target, n + 1, out.values.size(), out.target));
        if (std::find(out.values.begin(), out.values.begin() + static_cast<std::ptrdiff_t>(n),
                      out.values[n]) != out.values.begin() + static_cast<std::ptrdiff_t>(n))
            throw Failure(fmt::format("--over {}: {} is there twice; leave one out", out.target,
                                      out.values[n]));
    }
    return out;
}

}  // namespace

std::vector<Varied> read_varied(const std::vector<std::string>& texts) {
    std::vector<Varied> out;
    std::vector<std::size_t> sizes;
    std::size_t count = 1;
    for (const auto& text : texts) {
        auto varied = varied_of(text);
        if (std::ranges::find(out, varied.target, &Varied::target) != out.end())
            throw Failure(fmt::format("--over {} is there twice; put all of its values into one",
                                      varied.target));
        count = std::min(count, std::size_t{1'000'000}) * varied.values.size();
        sizes.push_back(varied.values.size());
        out.push_back(std::move(varied));
    }
    if (count > most_combinations)
        throw Failure(fmt::format(
            "--over: {} are {} combinations, and a wedge has at most {}; name fewer values",
            fmt::join(sizes, " x "), count, most_combinations));
    return out;
}

std::vector<Combination> combinations_of(const std::vector<Varied>& varied) {
    std::vector<Combination> out(1);
    for (const auto& [target, values] : varied) {
        std::vector<Combination> longer;
        for (const auto& each : out)
            for (const auto& value : values) {
                longer.push_back(each);
                longer.back().emplace_back(target, value);
            }
        out = std::move(longer);
    }
    return out;
}

std::string folder_name(const Combination& combination, std::size_t number) {
    auto out = fmt::format("{:02}", number);
    for (const auto& [target, value] : combination) out += fmt::format("_{}={}", target, value);
    constexpr std::size_t longest = 100;
    out.resize(std::min(out.size(), longest));
    for (char& c : out)
        if (!std::isalnum(static_cast<unsigned char>(c)) &&
            std::string_view("_=.+-").find(c) == std::string_view::npos)
            c = '_';
    return out;
}

}  // namespace fluidcarve
