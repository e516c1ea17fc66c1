#pragma once

#include <algorithm>
#include <cctype>
#include <map>
#include <regex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fluidcarve::test {

/// A value of a .usda file.
struct UsdaValue {
    /// Of a number, a text, <a path>, @a file@ or a word, without what encloses it.
    std::string text;
    std::vector<UsdaValue> items;                    ///< of (a, b) and [a, b]
    std::vector<std::pair<int, UsdaValue>> samples;  ///< of {1: a, 2: b}, in the order of the file
    std::map<std::string, UsdaValue> entries;        ///< of a dictionary, by type and name

    // Defined where the type is complete: clang 14 needs it for a list of pairs with itself.
    UsdaValue();
    UsdaValue(const UsdaValue&);
    UsdaValue(UsdaValue&&) noexcept;
    UsdaValue& operator=(const UsdaValue&);
    UsdaValue& operator=(UsdaValue&&) noexcept;
    ~UsdaValue();

    std::vector<std::string> texts() const {
        std::vector<std::string> out;
        for (const auto& item : items) out.push_back(item.text);
        return out;
    }
};
inline UsdaValue::UsdaValue() = default;
inline UsdaValue::UsdaValue(const UsdaValue&) = default;
inline UsdaValue::UsdaValue(UsdaValue&&) noexcept = default;
inline UsdaValue& UsdaValue::operator=(const UsdaValue&) = default;
inline UsdaValue& UsdaValue::operator=(UsdaValue&&) noexcept = default;
inline UsdaValue::~UsdaValue() = default;

/// A prim of a .usda file, or the file itself.
struct UsdaPrim {
    std::string type, name;
    std::map<std::string, UsdaValue> metadata;  ///< by what stands before the `=`
    /// By type and name: "asset filePath.timeSamples".
    std::map<std::string, UsdaValue> properties;
    /// By type and name.
    std::map<std::string, std::map<std::string, UsdaValue>> metadata_of_properties;
    std::vector<UsdaPrim> prims;

    const UsdaPrim& prim(const std::string& wanted) const {
        for (const auto& each : prims)
            if (each.name == wanted) return each;
        throw std::runtime_error("no prim " + wanted);
    }
};

/// Reads the part of USD's text format that fluidcarve writes, and throws on anything else.
class UsdaReader {
public:
    static UsdaPrim read(const std::string& text) { return UsdaReader(text).file(); }

private:
    explicit UsdaReader(const std::string& text) : text_(text) {}

    UsdaPrim file() {
        UsdaPrim out;
        if (!text_.starts_with("#usda 1.0\n")) fault("#usda 1.0");
        at_ = 9;
        // Comments may stand behind the first line.
        while (text_.compare(at_, 3, "\n# ") == 0) at_ = text_.find('\n', at_ + 1);
        want('(');
        out.metadata = fields(')');
        while (!ended()) add_prim(out);
        return out;
    }

    void add_prim(UsdaPrim& to) {
        if (word() != "def") fault("def");
        UsdaPrim out;
        if (peek() != '"') out.type = word();
        out.name = value().text;
        if (!std::regex_match(out.name, std::regex("[A-Za-z_][A-Za-z0-9_]*")))
            fault("a legal name");
        if (take('(')) out.metadata = fields(')');
        want('{');
        while (!take('}'))
            if (text_.substr(at_, 4) == "def ") add_prim(out);
            else add_property(out);
        for (const auto& each : to.prims)
            if (each.name == out.name) fault("another name than " + out.name);
        to.prims.push_back(std::move(out));
    }

    void add_property(UsdaPrim& to) {
        const auto declared = declaration();
        static const std::regex legal(
            R"((uniform )?[a-z][a-z0-9A-Z]*(\[\])? [A-Za-z_][A-Za-z0-9_]*(:[A-Za-z_][A-Za-z0-9_]*)*(\.timeSamples)?)");
        if (!std::regex_match(declared, legal)) fault("a type and a legal name, not " + declared);
        if (take('=') && !to.properties.emplace(declared, value()).second)
            fault(declared + " but once");
        if (take('(')) to.metadata_of_properties[declared] = fields(')');
    }

    /// Fields until a bracket.
    std::map<std::string, UsdaValue> fields(char end) {
        std::map<std::string, UsdaValue> out;
        while (!take(end)) {
            const auto declared = declaration();
            want('=');
            if (!out.emplace(declared, value()).second) fault(declared + " but once");
        }
        return out;
    }

    UsdaValue value() {
        UsdaValue out;
        switch (peek()) {
            case '"': out.text = quoted(); break;
            case '@': out.text = file_name(); break;
            case '<': out.text = until('<', ">"); break;
            case '(': out.items = items('(', ')'); break;
            case '[': out.items = items('[', ']'); break;
            case '{':
                want('{');
                if (std::isdigit(static_cast<unsigned char>(peek())) || peek() == '-')
                    out.samples = samples();
                else out.entries = fields('}');
                break;
            default: out.text = word();
        }
        return out;
    }

    std::vector<UsdaValue> items(char begin, char end) {
        std::vector<UsdaValue> out;
        want(begin);
        if (take(end)) return out;
        do out.push_back(value());
        while (take(','));
        want(end);
        return out;
    }

    std::vector<std::pair<int, UsdaValue>> samples() {
        std::vector<std::pair<int, UsdaValue>> out;
        while (!take('}')) {
            const auto time = word();
            want(':');
            out.emplace_back(std::stoi(time), value());
            want(',');
        }
        return out;
    }

    std::string quoted() {
        std::string out;
        for (want('"'); text_.at(at_) != '"'; ++at_) {
            if (text_[at_] == '\n') fault("the end of a text");
            if (text_[at_] != '\\') {
                out += text_[at_];
            } else if (text_.at(++at_) == 'x') {
                out += static_cast<char>(std::stoi(text_.substr(at_ + 1, 2), nullptr, 16));
                at_ += 2;
            } else {
                out += text_[at_];
            }
        }
        ++at_;
        return out;
    }

    std::string file_name() {
        if (text_.substr(at_, 3) != "@@@") return until('@', "@");
        at_ += 2;
        auto out = until('@', "@@@");
        while (out.ends_with('\\')) {
            out.replace(out.size() - 1, 1, "@@@");
            --at_;
            out += until('@', "@@@");
        }
        return out;
    }

    /// @param begin  the character here
    std::string until(char begin, std::string_view end) {
        want(begin);
        const auto found = text_.find(end, at_);
        if (found == std::string::npos) fault(std::string(end));
        auto out = text_.substr(at_, found - at_);
        at_ = found + end.size();
        return out;
    }

    /// Words of one line before a `=` or a bracket.
    std::string declaration() {
        auto out = word();
        for (; text_[at_] == ' ' && in_word(text_[at_ + 1]);) out += " " + word();
        return out;
    }

    std::string word() {
        peek();
        const auto begin = at_;
        // A colon belongs to a name if the name goes on behind it.
        while (at_ < text_.size() && in_word(text_[at_]) &&
               (text_[at_] != ':' || in_word(text_[at_ + 1])))
            ++at_;
        // An array's type ends with its brackets.
        if (text_.substr(at_, 2) == "[]" && at_ > begin) at_ += 2;
        if (at_ == begin) fault("a word");
        return text_.substr(begin, at_ - begin);
    }

    static bool in_word(char c) {
        return std::isalnum(static_cast<unsigned char>(c)) ||
               (c != '\0' && std::string_view("_:.+-").find(c) != std::string_view::npos);
    }

    bool ended() { return peek() == '\0'; }
    char peek() {
        while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n')) ++at_;
        return at_ < text_.size() ? text_[at_] : '\0';
    }
    bool take(char c) {
        if (peek() != c) return false;
        ++at_;
        return true;
    }
    void want(char c) {
        if (!take(c)) fault(std::string(1, c));
    }
    [[noreturn]] void fault(const std::string& wanted) const {
        throw std::runtime_error(
            "line " +
            std::to_string(1 + std::count(text_.begin(),
                                          text_.begin() + static_cast<std::ptrdiff_t>(
                                                              std::min(at_, text_.size())),
                                          '\n')) +
            " of the .usda file lacks " + wanted);
    }

    const std::string& text_;
    std::size_t at_ = 0;
};

}  // namespace fluidcarve::test
