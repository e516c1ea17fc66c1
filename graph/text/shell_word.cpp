#include "graph/text/shell_word.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>

namespace fluidcarve {

std::string shell_word(const std::string& word) {
    const auto plain = [](unsigned char c) {
        return std::isalnum(c) ||
               std::string_view("_-./=+,:@%#").find(static_cast<char>(c)) != std::string_view::npos;
    };
    const auto foreign = [](unsigned char c) { return c < 0x20 || c > 0x7e; };
    if (!word.empty() && word[0] != '#' && std::ranges::all_of(word, plain)) return word;
    const bool escapes = std::ranges::any_of(word, foreign);
    std::string out = escapes ? "$'" : "'";
    for (const char c : word) {
        if (escapes && foreign(static_cast<unsigned char>(c)))
            out += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
        else if (escapes && (c == '\'' || c == '\\')) out += std::string("\\") + c;
        else if (c == '\'') out += "'\\''";
        else out += c;
    }
    return out + "'";
}

std::string shell_line(const std::vector<std::string>& words) {
    std::string out;
    for (const auto& word : words) out += (out.empty() ? "" : " ") + shell_word(word);
    return out;
}

}  // namespace fluidcarve
