#include "tests/fuzz/damage.h"

#include <algorithm>
#include <cctype>

namespace fuzz {

std::string damaged(std::string file, Random& random) {
    const auto count = 1 + below(random, 6);
    for (std::size_t n = 0; n < count && file.size() > 8; ++n) {
        // Half of all faults near the front, where the structure is.
        const auto at = below(
            random, random() % 2 ? file.size() - 8 : std::min<std::size_t>(file.size() - 8, 2000));
        const auto kind = below(random, 10);
        if (kind < 3) {
            file[at] = static_cast<char>(file[at] ^ (1 << below(random, 8)));
        } else if (kind < 5) {
            file[at] = static_cast<char>(random());
        } else if (kind < 8) {
            constexpr std::array<std::uint32_t, 6> numbers{0,          0xFFFFFFFF, 0x7FFFFFFF,
                                                           0x80000000, 0x10000,    0xFFFF};
            set_number(file, at, any_of(numbers, random));
        } else if (kind == 8) {
            const auto from = below(random, file.size()),
                       length = std::min(below(random, 200), file.size() - std::max(at, from));
            file.replace(at, length, file.substr(from, length));
        } else if (random() % 2) {
            file.erase(at, below(random, 200));
        } else {
            file.insert(at, file.substr(below(random, file.size()), below(random, 200)));
        }
    }
    return file;
}

std::string mistyped(std::string text, Random& random) {
    constexpr std::array pieces{"&a",          "*a",         "<<: *a",
                                "{",           "}",          "[",
                                "]",           "\t",         "\"",
                                "'",           ": ",         "\n",
                                "- ",          "!!x",        "%Y 1",
                                "---",         "...",        "\0",
                                "|\n",         "${count}",   "${}",
                                "#",           "9e999",      "-1000000000",
                                "nan",         "1-99999999", "~",
                                "? ",          "\xff\xfe",   "extends: plume.yaml\n",
                                "seams.seams", "sim",        "[[[[[[[[[[[[[[[["};
    const auto count = 1 + below(random, 5);
    for (std::size_t n = 0; n < count && text.size() > 8; ++n) {
        const auto at = below(random, text.size());
        const auto line = text.rfind('\n', at) + 1, next = text.find('\n', at);
        switch (random() % 6) {
            case 0: text.insert(at, any_of(pieces, random)); break;
            case 1: text.erase(at, 1 + below(random, 12)); break;
            case 2: text.erase(line, next == std::string::npos ? next : next - line + 1); break;
            case 3:
                text.insert(line,
                            text.substr(line, next == std::string::npos ? next : next - line + 1));
                break;
            case 4: std::swap(text[at], text[below(random, text.size())]); break;
            default: text.replace(at, 1, any_of(pieces, random)); break;
        }
    }
    return text;
}

std::string retold(std::string text, Random& random) {
    constexpr std::array words{"0",          "-1",          "1",          "2147483647",
                               "2147483648", "-2147483648", "4294967295", "99999999999999999999",
                               "1e38",       "-1e300",      "1e-300",     "nan",
                               "-inf",       "1e9999",      "0x10",       "",
                               "\n",         "1000000000/", "1/1/1",      "list ",
                               "uchar",      "\xff"};
    const auto ends_word = [](char c) {
        return std::isspace(static_cast<unsigned char>(c)) || c == ',' || c == '/';
    };
    const auto count = 1 + below(random, 3);
    for (std::size_t n = 0; n < count && !text.empty(); ++n) {
        const auto at =
            text.begin() +
            static_cast<std::ptrdiff_t>(below(
                random, random() % 2 ? text.size() : std::min<std::size_t>(text.size(), 300)));
        const auto begin =
            std::find_if(std::make_reverse_iterator(at), text.rend(), ends_word).base();
        text.replace(begin, std::find_if(at, text.end(), ends_word), any_of(words, random));
    }
    return text;
}

}  // namespace fuzz
