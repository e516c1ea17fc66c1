#include "formats/file/path_pattern.h"

#include "carve/base/numbers.h"

#include <fmt/format.h>

#include <glob.h>
#include <algorithm>
#include <filesystem>
#include <utility>

namespace fluidcarve {

namespace {

constexpr int most_digits = 10;

bool digit(char c) { return c >= '0' && c <= '9'; }

bool letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

bool word(char c) { return letter(c) || digit(c); }

/// The frame token at the start of a text.
struct Token {
    std::size_t length = 0;  ///< characters; 0: no token
    int digits = 0;          ///< minimum digits of the number; 0: it only looks like a token
};

std::size_t count(std::string_view text, std::size_t from, bool (*wanted)(char)) {
    std::size_t n = from;
    while (n < text.size() && wanted(text[n])) ++n;
    return n - from;
}

/// Parses the width of a token: number of digits, 0 if the text is not a valid width.
int width_of(std::string_view text) {
    const auto out = number_of<int>(text).value_or(0);
    return out <= most_digits ? out : 0;
}

Token percent_token(std::string_view text) {
    const auto wide = count(text, 1, digit);
    const auto end = 1 + wide;
    if (end >= text.size()) return {};
    if (text[end] == 'd') {
        if (wide == 0) return {2, 1};
        // %4d would pad with blanks.
        return {end + 1, text[1] == '0' ? width_of(text.substr(1, wide)) : 0};
    }
    const bool other_format = wide > 0 && text[1] == '0' &&
                              std::string_view("iuxXof").find(text[end]) != std::string_view::npos;
    return other_format ? Token{end + 1, 0} : Token{};
}

Token dollar_token(std::string_view text) {
    if (text.starts_with("${")) return {2, 0};
    if (text.starts_with("$F")) {
        const auto wide = count(text, 2, digit);
        if (wide > 0) return {2 + wide, width_of(text.substr(2, wide))};
        if (text.size() == 2 || !letter(text[2])) return {2, 1};
    }
    return text.size() > 1 && letter(text[1]) ? Token{1 + count(text, 1, word), 0} : Token{};
}

Token angle_token(std::string_view text) {
    const auto inside = text.substr(1, count(text, 1, word));
    const auto end = 1 + inside.size();
    const bool closed = end < text.size() && text[end] == '>';
    if (closed && inside == "frame") return {end + 1, 1};
    if (closed && inside.starts_with("frame0")) return {end + 1, width_of(inside.substr(5))};
    if (closed && !inside.empty() && letter(inside[0])) return {end + 1, 0};
    return inside.starts_with("frame") ? Token{end, 0} : Token{};
}

Token token_at(std::string_view text) {
    switch (text.front()) {
        case '#': {
            const auto wide = text.find_first_not_of('#') == std::string_view::npos
                                  ? text.size()
                                  : text.find_first_not_of('#');
            return {wide, wide <= most_digits ? static_cast<int>(wide) : 0};
        }
        case '@': {
            // `@` is fileseq's other padding character; a single one is common in file names.
            const auto wide = text.find_first_not_of('@') == std::string_view::npos
                                  ? text.size()
                                  : text.find_first_not_of('@');
            return wide > 1 ? Token{wide, 0} : Token{};
        }
        case '%': return percent_token(text);
        case '$': return dollar_token(text);
        case '<': return angle_token(text);
        default: return {};
    }
}

std::string in_folder(const std::string& folder, const std::string& path) {
    return folder.empty() || path.starts_with('/')
               ? path
               : folder + (folder.ends_with('/') ? "" : "/") + path;
}

std::string escaped_for_glob(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (std::string_view("*?[]\\").find(c) != std::string_view::npos) out += '\\';
        out += c;
    }
    return out;
}

}  // namespace

bool NameEnds::fits(const NameEnds& other) const {
    // Where the longer name continues, the other has a number, which begins with a minus or a
    // digit and ends with a digit.
    const auto [less, more] = std::minmax(
        begin, other.begin, [](const auto& a, const auto& b) { return a.size() < b.size(); });
    if (!more.starts_with(less) ||
        (more.size() > less.size() && !digit(more[less.size()]) && more[less.size()] != '-'))
        return false;
    const auto [shorter, longer] = std::minmax(
        end, other.end, [](const auto& a, const auto& b) { return a.size() < b.size(); });
    return longer.ends_with(shorter) &&
           (longer.size() == shorter.size() || digit(longer[longer.size() - shorter.size() - 1]));
}

PathPattern::PathPattern(std::string text, std::string folder)
    : text_(std::move(text)), folder_(std::move(folder)) {
    const std::string_view all = text_;
    std::string literal;
    for (std::size_t n = 0; n < all.size();) {
        const auto token = token_at(all.substr(n));
        if (token.digits > 0) {
            if (!literal.empty()) parts_.push_back({std::exchange(literal, {}), 0});
            parts_.push_back({{}, token.digits});
            per_frame_ = true;
            n += token.length;
            continue;
        }
        if (token.length > 0 && bad_token_.empty()) bad_token_ = all.substr(n, token.length);
        const auto length = std::max<std::size_t>(token.length, 1);
        literal += all.substr(n, length);
        n += length;
    }
    if (!literal.empty()) parts_.push_back({std::move(literal), 0});
}

PathPattern PathPattern::literal(std::string path) {
    PathPattern out;
    out.parts_.push_back({path, 0});
    out.text_ = std::move(path);
    return out;
}

std::string PathPattern::at(int frame) const {
    std::string out;
    for (const auto& part : parts_)
        out += part.digits == 0 ? part.text : fmt::format("{:0{}}", frame, part.digits);
    return in_folder(folder_, out);
}

std::optional<NameEnds> PathPattern::name_ends() const {
    NameEnds out;
    bool numbered = false;
    for (const auto& part : parts_) {
        const auto slash = part.text.rfind('/');
        if (numbered && slash != std::string::npos) return std::nullopt;
        out.end = slash == std::string::npos ? part.text : part.text.substr(slash + 1);
        if (part.digits > 0) numbered = true;
        else if (!numbered) out.begin = out.end;
    }
    return out;
}

std::string with_frame_token(const std::string& path) {
    constexpr auto digits = "0123456789";
    const auto name = path.rfind('/') + 1;
    const auto ending = path.rfind('.');
    if (ending == std::string::npos || ending <= name) return {};
    const auto last = path.find_last_of(digits, ending - 1);
    if (last == std::string::npos || last < name) return {};
    const auto before = path.find_last_not_of(digits, last);
    const auto first = std::max(name, before == std::string::npos ? 0 : before + 1);
    if (last + 1 - first > static_cast<std::size_t>(most_digits)) return {};
    return path.substr(0, first) + std::string(last + 1 - first, '#') + path.substr(last + 1);
}

std::string PathPattern::in_its_folder() const { return in_folder(folder_, text_); }

bool PathPattern::exists() const {
    if (!per_frame_) {
        std::error_code ignored;
        return std::filesystem::exists(in_its_folder(), ignored);
    }
    std::string pattern;
    for (const auto& part : parts_) {
        if (part.digits == 0) {
            pattern += escaped_for_glob(part.text);
            continue;
        }
        pattern += "[-0-9]";
        for (int n = 1; n < part.digits; ++n) pattern += "[0-9]";
        pattern += "*";
    }
    glob_t found{};
    const int status =
        glob(in_folder(escaped_for_glob(folder_), pattern).c_str(), GLOB_NOSORT, nullptr, &found);
    globfree(&found);
    return status == 0;
}

}  // namespace fluidcarve
